"""A mended source object shows what was added, in its mesh files as in its triangles."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from triangle_box import box

from artigen.api import mend
from artigen.api.convert import ConvertJob, ConvertSettings
from artigen.api.mend import mend_object, resize_object
from artigen.datasets import sources
from artigen.datasets.source_object import SourceObject, TriangleMesh
from artigen.files.wavefront import read_obj
from artigen.types import FIXED, Asset, Part, SurfaceSamples


def test_a_mended_object_shows_its_posts(tmp_path):
    frame = box((0.0, 0.0, 0.0), (0.4, 0.4, 0.1))
    lamp = box((0.1, 0.1, 0.12), (0.2, 0.2, 0.2))
    surface = SurfaceSamples(
        points=frame.reshape(-1, 3),
        normals=np.tile([0.0, 0.0, 1.0], (36, 1)),
        colors=np.zeros((36, 3), dtype=np.uint8),
        part_ids=np.zeros(36, dtype=int),
    )
    corners = np.concatenate([frame, lamp]) / 2.0  # two metres are the unit
    asset = Asset(
        name="lamp",
        category="Lamp",
        scale=2.0,
        parts=(
            Part(name="base", label="base", parent=-1, joint=FIXED, box=np.array([np.zeros(3), np.ones(3)])),
        ),
        surface=surface,
    )
    source = SourceObject(
        asset=asset,
        visuals=(),
        triangles=TriangleMesh(
            vertices=corners.reshape(-1, 3),
            faces=np.arange(72).reshape(-1, 3),
            part_ids=np.zeros(24, dtype=int),
        ),
        tables=(),
    )
    mended = mend_object(source, tmp_path)
    (visual,) = mended.visuals
    shown = read_obj(visual.path, tmp_path).vertices * visual.scale
    assert (shown.min(axis=0) >= 0.0).all()
    assert shown[:, 2].max() - shown[:, 2].min() == pytest.approx((0.02 + 0.012) / 2.0)
    assert len(mended.triangles.faces) == len(source.triangles.faces) + 12
    assert mended.asset.surface is not None
    assert len(mended.asset.surface.points) > 36
    assert any("bridge (V107)" in note for note in mended.asset.notes)


@pytest.mark.parametrize(
    ("category", "scale", "size"),
    [
        ("Refrigerator", 0.23, 1.75),
        ("Refrigerator", 1.2, 1.2),
        ("Refrigerator", 3.0, 1.75),
        ("Gizmo", 0.01, 0.01),
    ],
)
def test_what_has_the_size_of_no_object_of_its_kind_gets_the_usual_one(
    category: str, scale: float, size: float
):
    corners = box((-0.2, -0.2, -0.5), (0.2, 0.2, 0.5))
    base = Part(name="base", label="base", parent=-1, joint=FIXED, box=np.array([np.zeros(3), np.ones(3)]))
    source = SourceObject(
        asset=Asset(name="thing", category=category, scale=scale, parts=(base,)),
        visuals=(),
        triangles=TriangleMesh(
            vertices=corners.reshape(-1, 3),
            faces=np.arange(36).reshape(-1, 3),
            part_ids=np.zeros(12, dtype=int),
        ),
        tables=(),
    )
    resized = resize_object(source)
    assert resized.asset.scale == pytest.approx(size)
    assert (resized is source) == (size == scale)


@pytest.mark.parametrize(("visual", "expected"), [("source", 0.0), ("voxels", 0.02)])
def test_handles_keep_room_for_a_cell_where_an_object_is_rebuilt(visual, expected, monkeypatch, tmp_path):
    monkeypatch.setattr(sources, "read_source", lambda *_: SimpleNamespace(asset=SimpleNamespace(scale=1.28)))
    monkeypatch.setattr(mend, "mend_object", lambda source, scratch, cell: cell)
    job = ConvertJob(
        source=Path("fridge"), out=tmp_path, cfg=ConvertSettings(visual=visual, mend=True, size=1.28)
    )
    assert job.read(tmp_path) == pytest.approx(expected)
