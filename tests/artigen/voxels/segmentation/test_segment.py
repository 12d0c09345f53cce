"""Voxel fields back to parts: both recipes, the tree, regularisation, and noise of the paper's size."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from field_noise import TABLE_4, TABLES_3_AND_4, FieldNoise, add_noise
from scipy.stats import chi2
from segment_score import part_overlaps, score_segmentation

from artigen.errors import SegmentationError
from artigen.types import (
    FIXED,
    FULL_TURN,
    PART_LABELS,
    Asset,
    Joint,
    JointType,
    Part,
    PartLabel,
    SurfaceSamples,
    VoxelGrid,
)
from artigen.voxels.fields import VoxelFields, decode, encode
from artigen.voxels.regions import connected_groups
from artigen.voxels.segmentation.aggregate import (
    aggregate_part,
    dominant_axis,
    fuse_box,
    nearest_point_to_lines,
)
from artigen.voxels.segmentation.neighbours import neighbour_pairs
from artigen.voxels.segmentation.segment import SegmentConfig, partition_paper, regularise, segment
from artigen.voxels.segmentation.segment_robust import OVERLONG, _explained_below, partition_robust
from artigen.voxels.segmentation.tree import ALLOWED_PARENTS
from artigen.voxels.segmentation.votes import overlong_axis
from artigen.voxels.voxelize import voxelize

PAPER = SegmentConfig(recipe="paper")
FRONT, GAP = -0.25, 0.002
Box = tuple[tuple[float, float, float], tuple[float, float, float]]


class Drawing:
    """Collects boxes with a label and a joint, and turns them into a voxelised asset."""

    def __init__(self) -> None:
        self.bodies: list[tuple[PartLabel, list[Box], int, Joint]] = []

    def add(self, label: PartLabel, boxes: list[Box], parent: int = 0, joint: Joint = FIXED) -> int:
        self.bodies.append((label, boxes, parent, joint))
        return len(self.bodies) - 1

    def asset(self, seed: int = 0, spacing: float = 0.005) -> Asset:
        rng = np.random.default_rng(seed)
        parts, points, ids = [], [], []
        for index, (label, boxes, parent, joint) in enumerate(self.bodies):
            corners = np.array(boxes)
            low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
            box = np.stack([(low + high) / 2, high - low])
            parent = -1 if index == 0 else parent
            parts.append(Part(name=f"{label}{index}", label=label, parent=parent, joint=joint, box=box))
            for start, end in corners:
                for axis in range(3):
                    count = max(4, round(float(np.delete(end - start, axis).prod()) / spacing**2))
                    for bound in (start, end):
                        at = rng.uniform(start, end, size=(count, 3))
                        at[:, axis] = bound[axis]
                        points.append(at)
                        ids.append(np.full(count, index))
        place = np.concatenate(points)
        surface = SurfaceSamples(
            points=place,
            normals=np.tile([0.0, 0.0, 1.0], (len(place), 1)),
            colors=np.zeros((len(place), 3), dtype=np.uint8),
            part_ids=np.concatenate(ids),
        )
        voxels = voxelize(surface)
        assert (np.bincount(voxels.part_ids, minlength=len(parts)) > 0).all()
        return Asset(
            name="drawn",
            category="StorageFurniture",
            scale=0.9,
            parts=tuple(parts),
            surface=surface,
            voxels=voxels,
        )


def moving(kind: JointType, axis, origin=(0.0, 0.0, 0.0), upper: float = 0.3, pitch: float = 0.0) -> Joint:
    return Joint(
        type=kind,
        axis=np.array(axis, dtype=float),
        origin=np.array(origin, dtype=float),
        upper=upper,
        pitch=pitch,
    )


def carcass(width: float = 0.9) -> Drawing:
    drawing = Drawing()
    half, wall = width / 2, 0.02
    drawing.add(
        "base",
        [
            ((FRONT + wall, -half, -0.5), (0.25, wall - half, 0.5)),
            ((FRONT + wall, half - wall, -0.5), (0.25, half, 0.5)),
            ((FRONT, -half, 0.48), (0.25, half, 0.5)),
            ((FRONT, -half, -0.5), (0.25, half, -0.46)),
            ((0.23, -half, -0.5), (0.25, half, 0.5)),
            ((FRONT, -half, 0.38), (FRONT + wall, half, 0.48)),
        ],
    )
    return drawing


def add_drawer(drawing: Drawing, y: tuple[float, float], z: tuple[float, float], upper: float = 0.3) -> int:
    front = ((FRONT, y[0] + GAP, z[0] + GAP), (FRONT + 0.02, y[1] - GAP, z[1] - GAP))
    tray = ((FRONT + 0.02, y[0] + 0.02, z[0] + 0.01), (0.18, y[1] - 0.02, z[0] + 0.02))
    sides = [
        ((FRONT + 0.02, at, z[0] + 0.01), (0.18, at + 0.01, z[0] + 0.8 * (z[1] - z[0])))
        for at in (y[0] + 0.02, y[1] - 0.03)
    ]
    drawer = drawing.add("drawer", [front, tray, *sides], joint=moving("prismatic", (-1, 0, 0), upper=upper))
    middle, level = sum(y) / 2, sum(z) / 2
    handle: Box = ((FRONT - 0.04, middle - 0.06, level - 0.008), (FRONT, middle + 0.06, level + 0.008))
    drawing.add("handle", [handle], drawer)
    return drawer


def drawers_and_doors(seed: int) -> Asset:
    """Two to four flat drawers in a stack (pitch down to 0.07) beside doors, with a row of knobs on top."""
    rng = np.random.default_rng(seed)
    drawing = carcass()
    level = 0.38
    for _ in range(int(rng.integers(2, 5))):
        height = rng.uniform(0.07, 0.12)
        add_drawer(drawing, (-0.44, 0.0), (level - height, level), rng.uniform(0.1, 0.3))
        level -= height
    for low, high, left in ((0.0, 0.22, True), (0.22, 0.44, False)):
        front: Box = ((FRONT, low + GAP, -0.46), (FRONT + 0.02, high - GAP, 0.38 - GAP))
        hinge = (FRONT, low if left else high, 0.0)
        opens = moving("revolute", (0, 0, 1 if left else -1), hinge, rng.uniform(1.2, 2.2))
        door = drawing.add("door", [front], joint=opens)
        edge = high - 0.03 if left else low + 0.03
        drawing.add("handle", [((FRONT - 0.04, edge - 0.008, -0.1), (FRONT, edge + 0.008, 0.05))], door)
    for k in range(int(rng.integers(2, 6))):
        y = -0.3 + 0.075 * k
        knob: Box = ((FRONT - 0.03, y - 0.017, 0.413), (FRONT, y + 0.017, 0.447))
        drawing.add("knob", [knob], joint=moving("continuous", (-1, 0, 0), (FRONT, y, 0.43), FULL_TURN))
    return drawing.asset(seed)


@pytest.fixture(scope="session")
def cabinet_fields(cabinet: Asset) -> VoxelFields:
    return decode(encode(cabinet))


@pytest.fixture(scope="session")
def fronts() -> list[Asset]:
    return [drawers_and_doors(seed) for seed in range(3)]


def name_map(truth: Asset, found: Asset) -> dict[int, int]:
    overlaps = part_overlaps(truth, found)
    assert (overlaps.max(axis=1) == 1.0).all()
    return {k: int(row.argmax()) for k, row in enumerate(overlaps)}


@pytest.mark.parametrize("cfg", [SegmentConfig(), PAPER], ids=["robust", "paper"])
def test_true_fields_of_the_cabinet_give_the_cabinet_back(cabinet: Asset, cabinet_fields, cfg):
    found = segment(cabinet_fields, cfg, name="again", scale=cabinet.scale)
    assert (found.name, found.category, found.scale) == ("again", "StorageFurniture", cabinet.scale)
    assert len(found.parts) == len(cabinet.parts)
    match = name_map(cabinet, found)
    for k, part in enumerate(cabinet.parts):
        again = found.parts[match[k]]
        assert again.label == part.label
        assert again.joint.type == part.joint.type
        assert again.parent == (-1 if part.parent == -1 else match[part.parent])
        assert np.allclose(again.box, part.box, atol=1e-5)
        if part.joint.type != "fixed":
            assert np.allclose(again.joint.axis, part.joint.axis, atol=1e-6)
            assert again.joint.lower == 0.0
            assert np.isclose(again.joint.upper, part.joint.upper, rtol=1e-5)
        if part.joint.type in ("revolute", "continuous"):
            assert np.linalg.norm(np.cross(again.joint.origin - part.joint.origin, part.joint.axis)) < 1e-5


def test_a_chain_of_two_joints_stays_a_chain(cabinet: Asset, cabinet_fields):
    found = segment(cabinet_fields, name="x", scale=1.0)
    knob = next(part for part in found.parts if part.label == "knob")
    door = found.parts[knob.parent]
    assert door.label == "door"
    assert found.parts[door.parent].name == "base"


def test_parts_are_named_from_top_to_bottom(fronts):
    found = segment(decode(encode(fronts[0])), name="x", scale=1.0)
    drawers = [part for part in found.parts if part.label == "drawer"]
    assert [part.name for part in drawers] == [f"drawer_{k}" for k in range(len(drawers))]
    heights = [part.box[0, 2] for part in drawers]
    assert len(drawers) >= 2
    assert heights == sorted(heights, reverse=True)


def test_the_same_fields_give_the_same_asset(fronts):
    noisy = add_noise(decode(encode(fronts[1])), TABLE_4, np.random.default_rng(5))
    one, two = (segment(noisy, name="x", scale=1.0) for _ in range(2))
    assert one.voxels is not None
    assert two.voxels is not None
    assert (one.voxels.part_ids == two.voxels.part_ids).all()
    assert [part.name for part in one.parts] == [part.name for part in two.parts]
    assert one.notes == two.notes


def test_flat_drawers_doors_and_knobs_are_found_with_true_fields(fronts):
    for asset in fronts:
        score = score_segmentation(asset, segment(decode(encode(asset)), name="x", scale=1.0))
        assert score.complete
        assert min(part.iou for part in score.parts) == 1.0
        assert all(part.parent_right in (True, None) for part in score.parts)


@pytest.mark.parametrize("noise", [TABLE_4, TABLES_3_AND_4], ids=["table 4", "tables 3 and 4"])
def test_flat_drawers_doors_and_knobs_are_found_with_the_papers_noise(fronts, noise):
    parts = []
    for seed, asset in enumerate(fronts):
        noisy = add_noise(decode(encode(asset)), noise, np.random.default_rng(seed))
        score = score_segmentation(asset, segment(noisy, name="x", scale=1.0))
        assert abs(score.found_parts - len(score.parts)) <= 1
        parts += score.parts
    assert np.mean([part.found for part in parts]) >= 0.95
    assert all(part.joint_type_right for part in parts if part.found)
    assert np.median([part.axis_degrees for part in parts if part.axis_degrees is not None]) < 1.0
    assert np.median([part.line_voxels for part in parts if part.line_voxels is not None]) < 0.5
    assert np.median([part.range_error for part in parts if part.range_error is not None]) < 0.02


def test_the_robust_recipe_beats_the_papers_on_flat_drawers_under_noise(fronts):
    found = {"robust": 0, "paper": 0}
    for seed, asset in enumerate(fronts):
        noisy = add_noise(decode(encode(asset)), TABLE_4, np.random.default_rng(seed))
        for recipe, cfg in (("robust", SegmentConfig()), ("paper", replace(PAPER, detached="note"))):
            score = score_segmentation(asset, segment(noisy, cfg, name="x", scale=1.0))
            found[recipe] += sum(part.found for part in score.parts)
    assert found["robust"] > found["paper"] > 0


def test_separate_pieces_of_base_are_one_base():
    drawing = Drawing()
    drawing.add("base", [((-0.2, -0.4, -0.5), (0.2, -0.38, 0.0)), ((-0.2, 0.38, -0.5), (0.2, 0.4, 0.0))])
    found = segment(decode(encode(drawing.asset())), name="x", scale=1.0)
    assert [part.name for part in found.parts] == ["base"]


def test_one_handle_of_two_separate_posts_is_one_part():
    drawing = carcass()
    drawer = add_drawer(drawing, (-0.44, 0.44), (0.0, 0.3))
    posts: list[Box] = [((FRONT - 0.05, y, 0.22), (FRONT, y + 0.02, 0.24)) for y in (-0.1, 0.1)]
    drawing.add("handle", posts, drawer)
    asset = drawing.asset()
    for seed, noise in enumerate((None, TABLE_4)):
        fields = decode(encode(asset))
        fields = fields if noise is None else add_noise(fields, noise, np.random.default_rng(seed))
        assert score_segmentation(asset, segment(fields, name="x", scale=1.0)).complete


def test_a_caster_wheel_hangs_from_its_stem():
    drawing = Drawing()
    drawing.add("base", [((-0.3, -0.3, -0.3), (0.3, 0.3, -0.2))])
    stem = drawing.add(
        "wheel",
        [((0.18, 0.18, -0.42), (0.26, 0.26, -0.3))],
        joint=moving("continuous", (0, 0, 1), (0.22, 0.22, 0.0), FULL_TURN),
    )
    drawing.add(
        "wheel",
        [((0.26, 0.15, -0.5), (0.3, 0.29, -0.36))],
        stem,
        moving("continuous", (1, 0, 0), (0.28, 0.22, -0.43), FULL_TURN),
    )
    found = segment(decode(encode(drawing.asset())), name="x", scale=1.0)
    chain = {part.name: part for part in found.parts}
    rolling = next(part for part in found.parts if part.label == "wheel" and abs(part.joint.axis[0]) > 0.9)
    assert abs(found.parts[rolling.parent].joint.axis[2]) > 0.9
    assert found.parts[found.parts[rolling.parent].parent].name == "base"
    assert len(chain) == 3


def test_a_screw_keeps_its_pitch():
    drawing = Drawing()
    drawing.add("base", [((-0.3, -0.3, -0.3), (0.3, 0.3, 0.0))])
    joint = moving("screw", (0, 0, 1), (0.05, 0.0, 0.0), 4.0, pitch=0.03)
    drawing.add("knob", [((-0.1, -0.1, 0.0), (0.2, 0.1, 0.1))], joint=joint)
    found = segment(decode(encode(drawing.asset())), name="x", scale=1.0)
    (knob,) = (part for part in found.parts if part.label == "knob")
    assert np.isclose(knob.joint.upper, 4.0, rtol=1e-5)
    assert np.isclose(knob.joint.pitch, 0.03, rtol=1e-5)


def floating(gap: float) -> Asset:
    drawing = Drawing()
    drawing.add("base", [((-0.3, -0.3, -0.3), (0.3, 0.3, 0.0))])
    drawing.add("drawer", [((-0.2, -0.2, gap), (0.2, 0.2, gap + 0.1))], joint=moving("prismatic", (-1, 0, 0)))
    return drawing.asset()


def test_a_part_out_of_reach_is_reported_or_noted_but_never_guessed():
    fields = decode(encode(floating(0.2)))
    with pytest.raises(SegmentationError, match="drawer_0"):
        segment(fields, name="x", scale=1.0)
    noted = segment(fields, SegmentConfig(detached="note"), name="x", scale=1.0)
    assert any("drawer_0" in note and "hung from the base" in note for note in noted.notes)
    near = segment(decode(encode(floating(0.03))), name="x", scale=1.0)
    assert near.parts[1].parent == 0
    assert near.notes == ()


def test_fields_without_a_base_or_without_voxels_are_refused(cabinet_fields):
    base = PART_LABELS.index("base")
    probs = cabinet_fields.label_probs.copy()
    probs[:, base] = 0.0
    probs[probs.sum(axis=1) == 0, base + 1] = 1.0
    with pytest.raises(SegmentationError, match="base"):
        segment(replace(cabinet_fields, label_probs=probs), name="x", scale=1.0)
    with pytest.raises(SegmentationError, match="no occupied voxel"):
        segment(decode(np.zeros((35, 16, 16, 16), dtype=np.float32)), name="x", scale=1.0)


def test_a_handful_of_voxels_still_has_its_parts(cabinet_fields):
    columns = {name: value[::3000] for name, value in vars(cabinet_fields).items() if np.ndim(value)}
    few = replace(cabinet_fields, **columns)
    found = segment(few, SegmentConfig(detached="note"), name="few", scale=1.0)
    said = {PART_LABELS[index] for index in few.label_probs.argmax(axis=1)}
    assert {part.label for part in found.parts} == said
    with pytest.raises(SegmentationError, match="no part lies within"):
        segment(few, name="few", scale=1.0)


def test_a_movable_part_without_an_axis_is_refused(cabinet_fields):
    with pytest.raises(SegmentationError, match="no axis"):
        segment(replace(cabinet_fields, axis=np.zeros_like(cabinet_fields.axis)), name="x", scale=1.0)


def test_wrong_labels_scattered_over_the_field_do_not_become_parts(cabinet: Asset, cabinet_fields):
    noise = FieldNoise(
        center=(0, 0, 0),
        size=(0, 0, 0),
        axis=(0, 0, 0),
        origin=(0, 0, 0),
        rotation=0,
        travel=0,
        label_error=0.05,
    )
    noisy = add_noise(cabinet_fields, noise, np.random.default_rng(0))
    assert (noisy.label_probs.argmax(axis=1) != cabinet_fields.label_probs.argmax(axis=1)).mean() > 0.03
    found = segment(noisy, name="x", scale=1.0)
    assert len(found.parts) == len(cabinet.parts)
    assert min(part_overlaps(cabinet, found).max(axis=1)) > 0.9


def test_votes_of_opposite_sign_agree_on_an_axis():
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    votes = np.concatenate([np.tile(axis, (60, 1)), np.tile(-axis, (40, 1)), np.zeros((50, 3))])
    assert np.allclose(dominant_axis(votes), axis)
    assert not dominant_axis(np.zeros((4, 3))).any()


def test_the_nearest_point_lies_on_all_lines_that_meet():
    rng = np.random.default_rng(0)
    at, axes = np.array([0.1, -0.2, 0.3]), rng.normal(size=(200, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    origins = at + 0.2 * rng.uniform(-1, 1, size=(200, 1)) * axes
    assert np.linalg.norm(nearest_point_to_lines(origins, axes) - at) < 0.02
    parallel = np.tile([0.0, 0.0, 1.0], (200, 1))
    origins = np.tile(at, (200, 1)) + rng.normal(size=(200, 1)) * parallel
    assert np.allclose(nearest_point_to_lines(origins, parallel)[:2], at[:2], atol=1e-12)


def test_a_voted_face_is_brought_to_the_extent_of_the_voxels():
    coords = np.stack(np.meshgrid(*[np.arange(20, 30)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    exact = np.array([25 / 64 - 0.5] * 3 + [9.5 / 64] * 3)
    assert np.allclose(fuse_box(exact, coords, 64), exact.reshape(2, 3))
    wild = exact + np.array([0.2, 0, 0, 0, 0, 0])
    fused = fuse_box(wild, coords, 64)
    low, high = fused[0] - fused[1] / 2, fused[0] + fused[1] / 2
    assert abs(low[0] - (20 / 64 - 0.5)) <= 2.01 / 64
    assert abs(high[0] - (30 / 64 - 0.5)) <= 2.01 / 64


def test_a_base_that_votes_to_move_is_held_and_noted(cabinet_fields):
    drawers = np.flatnonzero(cabinet_fields.joint_probs.argmax(axis=1) == 2)
    made = aggregate_part(cabinet_fields, drawers, name="base", label="base", method="robust")
    assert made.part.joint.type == "fixed"
    assert any("held fixed" in note for note in made.notes)


def slanted(degrees: float, kind: JointType = "revolute") -> Asset:
    angle = np.radians(degrees)
    joint = moving(kind, (np.sin(angle), 0, -np.cos(angle)), (0.3, 0.1, 0.0), FULL_TURN)
    base = Part(name="base", label="base", parent=-1, joint=FIXED, box=np.array([[0, 0, 0], [1, 1, 1.0]]))
    box = np.array([[0.3, 0.1, 0.0], [0.1, 0.1, 0.1]])
    return Asset(
        name="x", category="Oven", scale=1.0,
        parts=(base, Part(name="door_0", label="door", parent=0, joint=joint, box=box)),
    )  # fmt: skip


def test_nearly_square_axes_snap_and_slanted_ones_stay():
    snapped = regularise(slanted(0.8))
    assert np.allclose(snapped.parts[1].joint.axis, [0, 0, -1])
    assert len(snapped.notes) == 1
    assert "0.80 degrees" in snapped.notes[0]
    for degrees in (1.5, 4.0, 15.0):
        kept = regularise(slanted(degrees))
        assert np.allclose(kept.parts[1].joint.axis, slanted(degrees).parts[1].joint.axis)
        assert kept.notes == ()


def test_uncertain_axes_snap_from_farther_but_never_beyond_the_limit():
    uncertain = [(0.0, 0.0), (np.radians(2.0), 0.0)]
    assert np.allclose(regularise(slanted(5.0), uncertain).parts[1].joint.axis, [0, 0, -1])
    assert regularise(slanted(15.0), [(0.0, 0.0), (1.0, 0.0)]).notes == ()


def test_regularising_twice_changes_nothing_more():
    once = regularise(slanted(0.8, "continuous"))
    assert regularise(once).notes == once.notes


def test_neighbours_are_the_pairs_within_one_cell():
    coords = np.unique(np.random.default_rng(0).integers(0, 6, size=(60, 3)), axis=0)
    pairs = neighbour_pairs(coords, 6)
    apart = np.abs(coords[:, None] - coords[None]).max(axis=-1)
    expected = {(a, b) for a, b in np.argwhere(apart == 1) if a < b}
    assert {tuple(sorted(pair)) for pair in pairs.T.tolist()} == expected
    assert pairs.shape[1] == len(expected)


def test_links_decide_what_hangs_together():
    pairs = np.array([[0, 1, 2], [1, 2, 3]])
    groups = connected_groups(4, pairs[:, [0, 2]])
    assert groups[0] == groups[1] != groups[2] == groups[3]


def test_every_label_but_base_has_parents_that_exist():
    assert set(ALLOWED_PARENTS) == set(PART_LABELS) - {"base"}
    assert all(set(parents) <= set(PART_LABELS) and "base" in parents for parents in ALLOWED_PARENTS.values())


def test_scores_see_a_lost_part_and_a_part_too_many(cabinet: Asset):
    assert cabinet.voxels is not None
    assert score_segmentation(cabinet, cabinet).complete
    names = [part.name for part in cabinet.parts]
    ids = cabinet.voxels.part_ids.copy()
    ids[ids == names.index("lock")] = names.index("door")
    lost = score_segmentation(cabinet, replace(cabinet, voxels=replace(cabinet.voxels, part_ids=ids)))
    assert [part.name for part in lost.parts if not part.found] == ["lock"]
    extra = replace(cabinet.parts[1], name="shelf_2")
    assert not score_segmentation(cabinet, replace(cabinet, parts=(*cabinet.parts, extra))).complete
    grid = VoxelGrid(resolution=32, coords=np.zeros((1, 3), dtype=int), part_ids=np.zeros(1, dtype=int))
    with pytest.raises(ValueError, match="differ"):
        part_overlaps(cabinet, replace(cabinet, voxels=grid))


def test_noise_has_the_size_it_states(cabinet_fields):
    noisy = add_noise(cabinet_fields, TABLES_3_AND_4, np.random.default_rng(0))
    assert np.isclose(len(noisy.coords) / len(cabinet_fields.coords), 1 - TABLES_3_AND_4.missing, atol=0.003)
    plain = add_noise(cabinet_fields, TABLE_4, np.random.default_rng(0))
    smooth = add_noise(cabinet_fields, replace(TABLE_4, correlation=2.0), np.random.default_rng(0))
    for drawn in (plain, smooth):
        spread = (drawn.box - cabinet_fields.box).std(axis=0)
        assert np.allclose(spread, [*TABLE_4.center, *TABLE_4.size], rtol=0.3)
    pairs = neighbour_pairs(plain.coords.astype(np.int64), 64)
    rough, soft = (
        np.abs(np.diff((drawn.box - cabinet_fields.box)[pairs], axis=0)).mean() for drawn in (plain, smooth)
    )
    assert soft < 0.5 * rough


@pytest.mark.real
@pytest.mark.parametrize("key", ["7263", "45332", "24152"])
def test_real_objects_are_found_again_from_true_fields(real_objects, key):
    from artigen.datasets.partnet_mobility import read_object

    asset = read_object(real_objects / "partnet_mobility" / key).asset
    assert asset.surface is not None
    asset = replace(asset, voxels=voxelize(asset.surface))
    score = score_segmentation(asset, segment(decode(encode(asset)), name=key, scale=asset.scale))
    assert score.complete
    assert all(part.joint_type_right for part in score.parts)
    assert all(part.parent_right in (True, None) for part in score.parts)
    assert max(part.axis_degrees for part in score.parts if part.axis_degrees is not None) < 1.0
    assert max((part.line_voxels or 0.0) for part in score.parts) < 0.5
    assert max((part.range_error or 0.0) for part in score.parts) < 0.02


@pytest.mark.parametrize(("cells", "axis"), [(8.9, 1), (9.1, None)])
def test_a_row_of_parts_is_a_voxel_and_a_half_longer_than_it_votes(cells, axis):
    """Ten and a half cells long, the mean reach of a box of that length; exact votes."""
    votes: Any = SimpleNamespace(
        coords=np.array([(0, y, 0) for y in range(11)]),
        resolution=64,
        whitened=np.tile(np.array([1, cells, 1]) / 64, (11, 2)),
        sigma=np.ones(6),
        patch=1e-9,
    )
    assert overlong_axis(votes, np.arange(11), OVERLONG) == axis


@pytest.mark.parametrize(
    ("degrees", "error", "snaps"),
    [(0.99, 0.0, 1), (1.01, 0.0, 0), (5.9, 2.0, 1), (6.1, 2.0, 0), (7.9, 10.0, 1), (8.1, 10.0, 0)],
)
def test_axes_snap_within_a_degree_three_standard_errors_and_never_beyond_eight(degrees, error, snaps):
    made = regularise(slanted(degrees), [(0.0, 0.0), (np.radians(error), 0.0)])
    assert len(made.notes) == snaps


@pytest.mark.parametrize(
    ("cells", "error", "moved"),
    [(0.24, 0.0, 1), (0.26, 0.0, 0), (0.9, 0.31, 1), (0.95, 0.31, 0), (1.49, 1.0, 1), (1.51, 1.0, 0)],
)
def test_continuous_axes_move_by_a_quarter_cell_three_standard_errors_and_never_beyond_one_and_a_half(
    cells, error, moved
):
    dial = slanted(0.0, "continuous")
    part = dial.parts[1]
    origin = part.box[0] + np.array([cells / 64.0, 0.0, 0.0])
    off = replace(part, joint=replace(part.joint, origin=origin))
    made = regularise(replace(dial, parts=(dial.parts[0], off)), [(0.0, 0.0), (0.0, error / 64.0)])
    assert len(made.notes) == moved


def test_a_single_voxel_is_explained_up_to_eight_deviations_of_half_a_chi_squared():
    """Of fourteen votes; many voxels are explained by hardly more than the mean."""
    votes = chi2(14)
    limits = _explained_below(np.array([1, 16, 10_000]))
    assert 2.0 * limits[0] == pytest.approx(votes.mean() + 8.0 * votes.std())
    assert 2.0 * limits[1] == pytest.approx(votes.mean() + votes.std())
    assert 2.0 * limits[2] == pytest.approx(votes.mean(), rel=0.01)


@pytest.mark.parametrize(
    ("name", "channel", "end", "count"),
    [("axis", 2, 0.061, 3), ("axis", 2, 0.076, 4), ("box", 0, 0.0055, 3), ("box", 0, 0.0069, 4)],
)
def test_votes_may_drift_within_a_part_by_so_many_times_the_least_noise(
    name: str, channel: int, end: float, count: int
):
    """From 0 in the middle of a drawer to ``end`` at its sides; what drifts more is taken for two parts."""
    drawing = carcass()
    add_drawer(drawing, (-0.4, 0.4), (-0.3, 0.2))
    fields = decode(encode(drawing.asset()))
    drawer = fields.label_probs.argmax(axis=1) == PART_LABELS.index("drawer")
    places = fields.coords[:, 1].astype(float)
    share = (places - places[drawer].mean()) / (0.5 * np.ptp(places[drawer]))
    votes = getattr(fields, name).copy()
    votes[:, channel] += np.where(drawer, end * share, 0.0)
    found = partition_robust(replace(fields, **{name: votes}))
    assert len(found.labels) == count


def cluster(*votes: tuple[float, int]) -> int:
    """Parts that the paper's recipe makes of knobs: so many vote for the same place along y."""
    places = np.repeat([place for place, _ in votes], [count for _, count in votes])
    count = len(places) + 1
    labels = ["base", *["knob"] * len(places)]
    box = np.zeros((count, 6))
    box[1:, 1] = places
    fields = VoxelFields(
        resolution=64,
        coords=np.argwhere(np.ones((64, 64, 1)))[:count],
        label_probs=np.eye(len(PART_LABELS))[[PART_LABELS.index(label) for label in labels]],
        joint_probs=np.tile([1.0, 0.0, 0.0, 0.0, 0.0], (count, 1)),
        axis=np.zeros((count, 3)),
        origin=np.zeros((count, 3)),
        ranges=np.zeros((count, 2)),
        box=box,
        category_probs=np.zeros((count, 7)),
    )
    return len(partition_paper(fields).labels) - 1


@pytest.mark.parametrize(("apart", "parts"), [(0.079, 1), (0.081, 2)])
def test_votes_of_the_papers_parts_are_farther_apart_than_eight_hundredths(apart: float, parts: int):
    assert cluster((0.0, 8), (apart, 8)) == parts


@pytest.mark.parametrize(("count", "parts"), [(4, 1), (5, 2)])
def test_the_papers_parts_have_five_voxels_that_agree(count: int, parts: int):
    assert cluster((-0.4, 20), (0.4, count)) == parts


@pytest.mark.parametrize(("distinct", "parts"), [(3000, 1), (3001, 2)])
def test_of_more_than_three_thousand_votes_every_second_counts_twice(distinct: int, parts: int):
    """Three voxels that agree are not a part, and six are."""
    places = np.linspace(-0.4, 0.0, distinct - 1)
    assert cluster((-0.5, 3), *((float(place), 1) for place in places)) == parts
