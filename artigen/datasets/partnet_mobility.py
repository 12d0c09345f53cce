"""Reads PartNet-Mobility folders into an `Asset`: parts, joints, coloured surface, size in metres.

``mobility_v2.json`` defines parts and joints. Every decision (a moved rest pose, a missing mesh, a URDF that
disagrees) is a note in ``asset.notes``. The URDF, an export of the annotation that redistributors have
sometimes edited, is used to find meshes only. See docs/reference/partnet_mobility.md.
"""

import logging
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from artigen.datasets.mechanism import Mechanism
from artigen.datasets.part_labels import label_nodes
from artigen.datasets.partnet_annotation import SourceNode, read_json, read_nodes, read_piece_files
from artigen.datasets.partnet_joints import RestPose, closed_pose, describe_joint, joint_kind
from artigen.datasets.partnet_meshes import MESH_FOLDER, PieceMesh, read_pieces
from artigen.datasets.partnet_parts import order_nodes
from artigen.datasets.sizes import estimate_size
from artigen.datasets.source_object import ReaderConfig, SourceObject, SourceTree, assemble, collect_corners
from artigen.datasets.urdf_file import read_urdf
from artigen.errors import SourceError
from artigen.files.urdf import UrdfJoint
from artigen.transforms import T_ZUP_FROM_PARTNET
from artigen.types import PartLabel

logger = logging.getLogger(__name__)

POINTS_PER_NODE = 2000
"""Number of corners used to find the closed pose; more only take longer."""
EXPECTED_TYPES: dict[str, tuple[str, ...]] = {
    "fixed": ("fixed",),
    "revolute": ("revolute",),
    "prismatic": ("prismatic",),
    "continuous": ("continuous",),
    "screw": ("continuous", "revolute", "prismatic"),
}


def read_object(folder: Path, cfg: ReaderConfig | None = None) -> SourceObject:
    """Reads one PartNet-Mobility folder.

    Args:
        folder: Holds mobility_v2.json, mobility.urdf, meta.json, textured_objs/ and usually result.json.
        cfg: Sample count, seed and size; the defaults suit 64^3 voxels.

    Raises:
        SourceError: If the folder cannot be read; the message names file, element and value.
    """
    cfg = cfg or ReaderConfig()
    category = cfg.category or _read_category(folder / "meta.json")
    all_nodes = read_nodes(folder / "mobility_v2.json")
    nodes, notes = _keep_live(all_nodes, folder)
    urdf = read_urdf(folder / "mobility.urdf")
    check_scales(urdf, folder / "mobility.urdf")
    listing = folder / "result.json"
    files = read_piece_files(listing) if listing.exists() else {}
    pieces, mesh_notes = read_pieces(folder, all_nodes, frozenset(node.id for node in nodes), urdf, files)
    nodes, empty_notes = _keep_drawn(nodes, pieces, folder)
    turn, turn_notes = _find_turn(nodes, urdf)
    corners = collect_corners(pieces)
    labels, label_notes = label_nodes(order_nodes(nodes), corners, turn)
    poses = find_rest_poses(nodes, labels, corners)
    joint_notes = [note for node in nodes for note in (poses[node.id].note, describe_joint(node)) if note]
    found = assemble(
        SourceTree(nodes=nodes, pieces=pieces, labels=labels, poses=poses, T_zup_file=turn),
        cfg,
        name=folder.resolve().name,
        category=category,
        choose_size=lambda extents: choose_size(category, extents, cfg),
        notes=(
            *(*notes, *mesh_notes, *empty_notes, *compare_urdf(nodes, urdf)),
            *(*label_notes, *joint_notes, *turn_notes),
        ),
    )
    logger.info("%s: %d parts, %d mesh files", found.asset.name, len(found.asset.parts), len(found.visuals))
    return found


def _read_category(path: Path) -> str:
    value = read_json(path)
    category = value.get("model_cat") if isinstance(value, dict) else None
    if not isinstance(category, str) or not category:
        raise SourceError(f"{path}: 'model_cat' holds {category!r}, expected the name of a category")
    return category


def _keep_live(nodes: tuple[SourceNode, ...], folder: Path) -> tuple[tuple[SourceNode, ...], list[str]]:
    """Drops junk and its descendants; checks that one root remains."""
    dead = {node.id for node in nodes if node.joint == "junk"}
    while grown := {node.id for node in nodes if node.parent in dead} - dead:
        dead |= grown
    notes = [f"node {node.id} ({node.name}) is junk and was dropped" for node in nodes if node.id in dead]
    live = tuple(node for node in nodes if node.id not in dead)
    roots = [f"{node.id} ({node.name})" for node in live if node.parent == -1]
    if len(roots) != 1:
        raise SourceError(
            f"{folder / 'mobility_v2.json'}: {len(roots)} root nodes that are not junk"
            f" ({', '.join(roots) or 'none'}), expected one"
        )
    return live, notes


def _keep_drawn(
    nodes: tuple[SourceNode, ...], pieces: tuple[PieceMesh, ...], folder: Path
) -> tuple[tuple[SourceNode, ...], list[str]]:
    """Drops movable parts without any geometry in the source; a base without geometry is an error."""
    drawn = {piece.node for piece in pieces}
    notes = []
    for node in nodes:
        if node.id in drawn:
            continue
        where = f"{folder}: node {node.id} ({node.name})"
        if node.parent == -1:
            raise SourceError(
                f"{where} is the base and has no geometry: none of its mesh files is in {MESH_FOLDER}"
            )
        children = [child.id for child in nodes if child.parent == node.id]
        if children:
            raise SourceError(f"{where} has no geometry, but carries nodes {children}")
        notes.append(f"node {node.id} ({node.name}) was dropped: none of its mesh files exists")
    return tuple(node for node in nodes if node.id in drawn), notes


def find_rest_poses(
    nodes: Sequence[SourceNode],
    labels: Mapping[int, PartLabel],
    corners: Mapping[int, np.ndarray],
    choose: Callable[[SourceNode, PartLabel, np.ndarray, np.ndarray], RestPose] = closed_pose,
) -> dict[int, RestPose]:
    """Closed pose of every node, which ``choose`` finds; zero for nodes without a choice."""
    base = next(node.id for node in nodes if node.parent == -1)
    body = np.stack([corners[base].min(axis=0), corners[base].max(axis=0)])
    poses = {}
    for node in nodes:
        poses[node.id] = RestPose(rest=0.0, far=0.0)
        if joint_kind(node) in ("revolute", "prismatic", "screw"):
            stride = max(1, len(corners[node.id]) // POINTS_PER_NODE)
            poses[node.id] = choose(node, _closes_like(node, labels), corners[node.id][::stride], body)
    return poses


def _closes_like(node: SourceNode, labels: Mapping[int, PartLabel]) -> PartLabel:
    """The label by which the closed pose is chosen: levers of latches rest in the middle, as handles do."""
    lever = node.joint == "hinge" and (labels[node.id], labels[node.parent]) == ("knob", "door")
    return "handle" if lever else labels[node.id]


def _find_turn(nodes: tuple[SourceNode, ...], urdf: Mechanism) -> tuple[np.ndarray, list[str]]:
    """Rotation of mesh files to z up: that of the base in the URDF, which is nearly always the same."""
    base = next(node for node in nodes if node.parent == -1)
    placed = urdf.T_base_link.get(f"link_{base.id}")
    if placed is None or np.allclose(placed[:3, :3], T_ZUP_FROM_PARTNET[:3, :3], atol=1e-4):
        return T_ZUP_FROM_PARTNET, []
    turn = np.eye(4)
    turn[:3, :3] = placed[:3, :3]
    return turn, ["the URDF rotates the base differently from PartNet-Mobility; its rotation is used"]


def choose_size(category: str, extents: np.ndarray, cfg: ReaderConfig) -> tuple[float, tuple[str, ...]]:
    """Longest edge in metres of an object with normalised lengths, and a note if it is a guess."""
    if cfg.size is not None:
        return cfg.size, ()
    size, known = estimate_size(category, extents)
    if known:
        return size, ()
    return size, (f"category {category!r} has no known size, longest edge set to {size:g} m",)


def compare_urdf(nodes: tuple[SourceNode, ...], urdf: Mechanism) -> list[str]:
    """The differences of the URDF from mobility_v2.json, which is used."""
    joints = {joint.child: joint for joint in urdf.joints}
    changed = [
        change
        for node in nodes
        if node.parent != -1 and (change := _compare_joint(node, joints.get(f"link_{node.id}")))
    ]
    notes = []
    if changed:
        notes.append(f"the URDF differs from mobility_v2.json, which is used: {', '.join(changed)}")
    known = {f"link_{node.id}" for node in nodes} | {"base"}
    known |= {f"link_{node.id}_helper" for node in nodes if node.rotates}
    extra = [link for link in urdf.links if link not in known]
    if extra:
        notes.append(f"the URDF has links that mobility_v2.json does not know: {', '.join(extra)}")
    base = next(node for node in nodes if node.parent == -1)
    expected = urdf.T_base_link.get(f"link_{base.id}")
    if expected is not None:
        meshes = [visual for visual in urdf.elements if visual.kind == "mesh"]
        shifted = [v.link for v in meshes if not np.allclose(urdf.place(v), expected, atol=1e-4)]
        if shifted:
            notes.append(
                f"{len(shifted)} visuals are shifted by the URDF ({', '.join(dict.fromkeys(shifted))}); "
                "the places in their mesh files are used"
            )
    return notes


def _compare_joint(node: SourceNode, joint: UrdfJoint | None) -> str:
    kind = joint_kind(node)
    if joint is None:
        return f"link_{node.id} is missing"
    if joint.type not in EXPECTED_TYPES[kind]:
        return f"link_{node.id} is {joint.type} instead of {kind}"
    if kind in ("revolute", "prismatic"):
        span = abs(node.b - node.a) if kind == "prismatic" else np.radians(abs(node.b - node.a))
        said = (joint.upper or 0.0) - (joint.lower or 0.0)
        if abs(said - span) > 0.01 * span:
            return f"link_{node.id} spans {said:.4g} instead of {span:.4g}"
    return ""


def check_scales(urdf: Mechanism, path: Path) -> None:
    """Raises `SourceError` if the URDF scales a mesh, since the annotation has one unit of length."""
    for visual in urdf.elements:
        if visual.scale != (1.0, 1.0, 1.0):
            scale = " ".join(f"{value:g}" for value in visual.scale)
            raise SourceError(
                f"{path}: visual {visual.name!r} of link {visual.link!r}: mesh scale {scale!r}, "
                "expected 1 1 1"
            )
