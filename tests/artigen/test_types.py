"""Values are checked where they are made: every invalid one is refused with what was found and allowed."""

import importlib.util
import sys
from dataclasses import FrozenInstanceError, fields, is_dataclass, replace
from types import ModuleType

import numpy as np
import pytest

import artigen.types


def _without_hook() -> ModuleType:
    """`artigen.types` loaded apart from the suite's run-time type checks, which would answer first."""
    spec = importlib.util.spec_from_file_location("plain_artigen_types", artigen.types.__file__)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


types = _without_hook()
JOINT_TYPES, PART_LABELS, FIXED = types.JOINT_TYPES, types.PART_LABELS, types.FIXED
Joint, Part, Asset = types.Joint, types.Part, types.Asset
VoxelGrid, SurfaceSamples, Gaussians = types.VoxelGrid, types.SurfaceSamples, types.Gaussians

HINGE = Joint(type="revolute", axis=np.array([0.0, 0.0, 1.0]), origin=np.array([0.1, 0.2, 0.0]), upper=1.5)
BODY = Part(
    name="body", label="base", parent=-1, joint=FIXED, box=np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 0.8]])
)
DOOR = replace(BODY, name="door", label="door", parent=0, joint=HINGE)
VOXELS = VoxelGrid(resolution=8, coords=np.array([[0, 0, 0], [7, 3, 1]]), part_ids=np.array([0, 1]))
SURFACE = SurfaceSamples(
    points=np.zeros((2, 3)),
    normals=np.tile([0.0, 0.0, 1.0], (2, 1)),
    colors=np.zeros((2, 3), np.uint8),
    part_ids=np.array([0, 1]),
)
GAUSSIANS = Gaussians(
    means=np.zeros((2, 3)),
    quats=np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)),
    scales=np.full((2, 3), 0.01),
    opacities=np.ones(2),
    colors=np.zeros((2, 3)),
    part_ids=np.array([0, 1]),
)
ASSET = Asset(
    name="box", category="StorageFurniture", scale=0.8, parts=(BODY, DOOR),
    voxels=VOXELS, surface=SURFACE, gaussians=GAUSSIANS,
)  # fmt: skip
NAN = float("nan")

DEFECTS = {
    "joint type": (lambda: replace(HINGE, type="hinge"), ("'hinge'", *JOINT_TYPES)),
    "axis length": (lambda: replace(HINGE, axis=np.array([0.0, 0.0, 2.0])), ("length 2", "expected 1")),
    "axis just too long": (lambda: replace(HINGE, axis=np.array([0.0, 0.0, 1.000002])), ("expected 1",)),
    "axis zero": (lambda: replace(HINGE, axis=np.zeros(3)), ("length 0", "expected 1")),
    "axis shape": (lambda: replace(HINGE, axis=np.array([0.0, 1.0])), ("joint axis", "(2,)", "3")),
    "axis NaN": (lambda: replace(HINGE, axis=np.array([NAN, 0.0, 1.0])), ("joint axis", "NaN")),
    "origin NaN": (lambda: replace(HINGE, origin=np.array([0.0, NAN, 1.0])), ("joint origin", "NaN")),
    "origin infinite": (
        lambda: replace(HINGE, origin=np.array([0, np.inf, 0])),
        ("joint origin", "infinite"),
    ),
    "limit NaN": (lambda: replace(HINGE, upper=NAN), ("nan", "finite")),
    "limit infinite": (lambda: replace(HINGE, lower=-np.inf), ("-inf", "finite")),
    "friction NaN": (lambda: replace(HINGE, friction=NAN), ("friction nan", "finite")),
    "ratio infinite": (lambda: replace(HINGE, ratio=np.inf), ("ratio inf", "finite")),
    "pitch NaN": (lambda: replace(HINGE, type="screw", pitch=NAN), ("pitch nan", "finite")),
    "limits crossed": (lambda: replace(HINGE, lower=2.0), ("lower 2.0", "upper 1.5")),
    "fixed with range": (lambda: replace(HINGE, type="fixed"), ("fixed", "[0.0, 1.5]", "expected [0, 0]")),
    "pitch of a hinge": (lambda: replace(HINGE, pitch=0.1), ("revolute", "pitch 0.1", "screws")),
    "part label": (lambda: replace(DOOR, label="lid"), ("'door'", "'lid'", *PART_LABELS)),
    "box shape": (lambda: replace(DOOR, box=np.zeros((3, 2))), ("'door'", "(3, 2)", "2 x 3")),
    "box NaN": (lambda: replace(DOOR, box=np.full((2, 3), NAN)), ("'door'", "box", "NaN")),
    "box negative": (
        lambda: replace(DOOR, box=np.array([[0, 0, 0], [1.0, -0.2, 1]])),
        ("'door'", "[1.0, -0.2, 1.0]", "negative"),
    ),
    "voxel below": (lambda: replace(VOXELS, coords=np.array([[0, -1, 0], [1, 1, 1]])), ("-1..1", "0..7")),
    "voxel above": (lambda: replace(VOXELS, coords=np.array([[0, 0, 0], [8, 1, 1]])), ("0..8", "0..7")),
    "voxel ids": (lambda: replace(VOXELS, part_ids=np.array([0])), ("voxel part ids", "(1,)", "2")),
    "voxel shape": (
        lambda: replace(VOXELS, coords=np.zeros((2, 2), int)),
        ("voxel coords", "(2, 2)", "any x 3"),
    ),
    "surface normals": (
        lambda: replace(SURFACE, normals=np.zeros((3, 3))),
        ("surface normals", "(3, 3)", "2 x 3"),
    ),
    "surface NaN": (lambda: replace(SURFACE, points=np.full((2, 3), NAN)), ("surface points", "NaN")),
    "surface colors": (
        lambda: replace(SURFACE, colors=np.zeros((2, 4), np.uint8)),
        ("surface colors", "(2, 4)", "2 x 3"),
    ),
    "surface ids": (lambda: replace(SURFACE, part_ids=np.zeros(3, int)), ("surface part ids", "(3,)", "2")),
    "quaternion length": (
        lambda: replace(GAUSSIANS, quats=np.full((2, 4), 1.0)),
        ("quats", "2..2", "expected 1"),
    ),
    "Gaussian scales": (
        lambda: replace(GAUSSIANS, scales=np.zeros((2, 2))),
        ("Gaussian scales", "(2, 2)", "2 x 3"),
    ),
    "Gaussian opacities": (
        lambda: replace(GAUSSIANS, opacities=np.zeros(3)),
        ("Gaussian opacities", "(3,)", "2"),
    ),
    "Gaussian NaN": (lambda: replace(GAUSSIANS, means=np.full((2, 3), NAN)), ("Gaussian means", "NaN")),
    "no parts": (lambda: replace(ASSET, parts=()), ("'box'", "no parts")),
    "scale zero": (lambda: replace(ASSET, scale=0.0), ("'box'", "scale 0.0", "> 0")),
    "scale NaN": (lambda: replace(ASSET, scale=NAN), ("'box'", "scale nan", "> 0")),
    "names twice": (
        lambda: replace(ASSET, parts=(BODY, replace(DOOR, name="body"))),
        ("'box'", "twice", "body"),
    ),
    "two roots": (
        lambda: replace(ASSET, parts=(BODY, replace(DOOR, parent=-1))),
        ("2 roots", "body, door", "one"),
    ),
    "no root": (lambda: replace(ASSET, parts=(replace(BODY, parent=1), DOOR)), ("0 roots", "none", "one")),
    "own parent": (lambda: replace(ASSET, parts=(BODY, replace(DOOR, parent=1))), ("'door'", "own ancestor")),
    "parent missing": (
        lambda: replace(ASSET, parts=(BODY, replace(DOOR, parent=5))),
        ("'door'", "parent 5", "0..1"),
    ),
    "parent negative": (
        lambda: replace(ASSET, parts=(BODY, replace(DOOR, parent=-2))),
        ("parent -2", "0..1"),
    ),
    "voxels of no part": (
        lambda: replace(ASSET, voxels=replace(VOXELS, part_ids=np.array([0, 2]))),
        ("voxel part ids", "0..2", "0..1"),
    ),
    "surface of no part": (
        lambda: replace(ASSET, surface=replace(SURFACE, part_ids=np.array([-1, 1]))),
        ("surface part ids", "-1..1", "0..1"),
    ),
    "Gaussians of no part": (
        lambda: replace(ASSET, gaussians=replace(GAUSSIANS, part_ids=np.array([9, 1]))),
        ("Gaussian part ids", "1..9", "0..1"),
    ),
}


@pytest.mark.parametrize("defect", sorted(DEFECTS))
def test_invalid_values_are_refused_with_value_and_allowance(defect: str):
    build, words = DEFECTS[defect]
    with pytest.raises(ValueError, match=r"\S") as caught:
        build()
    message = str(caught.value)
    assert all(word in message for word in words), message
    assert "\n" not in message


def test_a_cycle_beside_the_root_is_refused():
    with pytest.raises(ValueError, match="'b' is its own ancestor"):
        types.check_tree("x", ["a", "b", "c"], [-1, 2, 1])
    types.check_tree("x", ["a", "b", "c"], [2, 0, -1])


@pytest.mark.parametrize("holder", [HINGE, DOOR, VOXELS, SURFACE, GAUSSIANS])
def test_arrays_are_copied_and_read_only(holder):
    names = [entry.name for entry in fields(holder) if isinstance(getattr(holder, entry.name), np.ndarray)]
    assert names
    for name in names:
        array = getattr(holder, name)
        assert not array.flags.writeable
        source = array.copy()
        again = replace(holder, **{name: source})
        source[...] = 0
        assert (getattr(again, name) == array).all()
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
        with pytest.raises(FrozenInstanceError):
            setattr(holder, name, source)


def test_joints_compare_by_value_and_all_others_by_identity():
    assert replace(HINGE) == HINGE
    assert replace(HINGE, upper=HINGE.upper + 0.1) != HINGE
    holders = [DOOR, VOXELS, SURFACE, GAUSSIANS, ASSET]
    assert all(is_dataclass(holder) for holder in holders)
    assert all(replace(holder) != holder for holder in holders)


def test_frozen_array_states_shape_and_type():
    array = types.frozen_array([[1, 2], [3, 4]], np.float32, (None, 2), "pairs")
    assert array.dtype == np.float32
    with pytest.raises(ValueError, match=r"pairs: shape \(2, 2\), expected any x 3"):
        types.frozen_array([[1, 2], [3, 4]], np.float32, (None, 3), "pairs")


def test_voxel_centers_fill_the_unit_cube():
    grid = VoxelGrid(resolution=4, coords=np.array(list(np.ndindex(4, 4, 4))), part_ids=np.zeros(64, int))
    centers = grid.centers()
    assert centers.min(axis=0) == pytest.approx([-0.375] * 3)
    assert centers.max(axis=0) == pytest.approx([0.375] * 3)
    assert centers.mean(axis=0) == pytest.approx([0.0] * 3)
    assert len(np.unique(np.floor((centers + 0.5) * 4), axis=0)) == 64


def test_the_root_is_found_wherever_it_stands():
    assert ASSET.root == 0
    turned = replace(ASSET, parts=(replace(DOOR, parent=1), BODY))
    assert turned.root == 1


def test_the_vocabulary_is_the_documented_one():
    assert PART_LABELS == ("base", "drawer", "door", "handle", "knob", "tray", "shelf", "wheel")
    assert JOINT_TYPES == ("fixed", "revolute", "prismatic", "continuous", "screw")
    for kind in JOINT_TYPES:
        assert replace(FIXED, type=kind).type == kind
    for label in PART_LABELS:
        assert replace(BODY, label=label).label == label
