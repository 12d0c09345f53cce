"""A file goes to the link that it touches only if it is small and far from its own link."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from triangle_box import box

from artigen.api.give_files import find_gifts, give_files
from artigen.datasets.partnet_surface import FaceTable
from artigen.datasets.source_object import SourceObject, SourceVisual, TriangleMesh
from artigen.types import FIXED, Asset, Joint, Part, SurfaceSamples
from sim_export.geometry.triangles import triangle_areas

SCALE = 2.0
SLIDE = Joint(type="prismatic", axis=np.array([-1.0, 0, 0]), origin=np.zeros(3), upper=0.1)
BODY = ((-0.3, 0, 0), (0.4, 0.8, 0.02))
DRAWER = ((-0.3, 0, 0.03), (-0.1, 0.2, 0.2))


def make_source(boxes, parts):
    """An object of boxes (m), each in a file of its own of the body (0), a drawer (1) or its handle (2)."""
    corners = [box(*ends) / SCALE for ends in boxes]
    points = np.concatenate([own.reshape(-1, 3) for own in corners])
    owners = np.repeat(parts, 12)
    unfit = np.array([np.zeros(3), np.ones(3)])
    asset = Asset(
        name="table",
        category="Table",
        scale=SCALE,
        parts=(
            Part(name="base", label="base", parent=-1, joint=FIXED, box=unfit),
            Part(name="drawer_0", label="drawer", parent=0, joint=SLIDE, box=unfit),
            Part(name="knob", label="handle", parent=1, joint=FIXED, box=unfit),
        ),
        surface=SurfaceSamples(
            points=points,
            normals=np.tile([0.0, 0.0, 1.0], (len(points), 1)),
            colors=np.zeros((len(points), 3), dtype=np.uint8),
            part_ids=np.repeat(owners, 3),
        ),
    )
    tables = tuple(
        FaceTable(
            vertices=own.reshape(-1, 3), faces=np.arange(36).reshape(-1, 3), corners=own,
            uv=np.zeros((12, 3, 2)), material_ids=np.zeros(12, dtype=int), materials=(),
        )
        for own in corners
    )  # fmt: skip
    visuals = tuple(
        SourceVisual(part=part, name="v", path=Path(f"{n}.obj"), T_unit_file=np.eye(4), scale=1.0)
        for n, part in enumerate(parts)
    )
    triangles = TriangleMesh(
        vertices=points, faces=np.arange(len(points)).reshape(-1, 3), part_ids=owners
    )  # fmt: skip
    return SourceObject(asset=asset, visuals=visuals, triangles=triangles, tables=tables)


def sliver(gap, over=0.0, size=0.02):
    """A file on top of the body, ``gap`` (m) behind the drawer and ``over`` above the body."""
    low = np.array([-0.1 + gap, 0.0, 0.02 + over])
    return low, low + size


@pytest.mark.parametrize(
    ("gap", "over", "given"),
    [
        (0.0505, 0, True),
        (0.0495, 0, False),
        (0.2, 0.99e-3, True),
        (0.2, 1.01e-3, False),
    ],
)
def test_only_files_5_cm_from_their_link_and_1_mm_from_another_are_given(gap, over, given):
    source = make_source([BODY, DRAWER, sliver(gap, over)], [0, 1, 1])
    done = give_files(source)
    taker = 0 if given else 1
    assert source.asset.surface is not None
    assert done.visuals[2].part == taker
    assert (done.triangles.part_ids[24:] == taker).all()
    assert done.asset.surface is not None
    assert (done.asset.surface.part_ids[72:] == taker).all()
    assert (done.asset.surface.part_ids[:72] == source.asset.surface.part_ids[:72]).all()
    assert any("mend give" in note for note in done.asset.notes) == given
    assert (done is source) == (not given)


@pytest.mark.parametrize(("share", "given"), [(0.095, 1), (0.105, 0)])
def test_a_piece_of_more_than_a_tenth_stays_with_its_link(share, given):
    whole = float(triangle_areas(box(*DRAWER)).sum())
    size = np.sqrt(share / (1.0 - share) * whole / 6.0)
    assert len(find_gifts(make_source([BODY, DRAWER, sliver(0.2, size=size)], [0, 1, 1]))) == given


@pytest.mark.parametrize(("away", "owner"), [(0.9e-4, 0), (1.1e-4, 1)])
def test_samples_within_a_ten_thousandth_of_a_given_file_go_with_it(away, owner):
    """In the unit cube; this one is above the middle of the file."""
    source = make_source([BODY, DRAWER, sliver(0.2)], [0, 1, 1])
    surface = source.asset.surface
    assert surface is not None
    points = np.array(surface.points)
    points[36] = np.array([0.11, 0.01, 0.04]) / SCALE + [0.0, 0.0, away]
    asset = replace(source.asset, surface=replace(surface, points=points))
    given = give_files(replace(source, asset=asset)).asset.surface
    assert given is not None
    assert given.part_ids[36] == owner


def test_what_stands_still_gives_nothing():
    lamp = ((1.0, 0, 0), (1.02, 0.02, 0.02))
    tray = ((1.0, 0, 0.02), (1.2, 0.2, 0.2))
    assert find_gifts(make_source([BODY, tray, lamp], [0, 1, 0])) == []


def test_parts_fit_their_boxes_when_a_file_of_a_handle_is_given():
    done = give_files(make_source([BODY, DRAWER, sliver(0.49)], [0, 1, 2]))
    assert (done.triangles.part_ids == np.repeat([0, 1, 0], 12)).all()
    assert done.asset.parts[0].box[1] == pytest.approx(np.array([0.71, 0.8, 0.04]) / SCALE)
