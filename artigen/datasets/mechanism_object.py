"""Turns a mechanism into a `SourceObject`: labels from names and joints, lengths in metres.

Links joined by fixed joints are one body; every moving joint makes a part. Guesses and omissions are notes in
``asset.notes``; a mechanism that is no articulated object is refused. See docs/how-to/convert.md.
"""

import logging
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from artigen.datasets.categories import guess_category
from artigen.datasets.mechanism import MOVING, Direction, Mechanism, Shape, Solid
from artigen.datasets.mechanism_joints import Tree, build_tree
from artigen.datasets.mesh_files import PlacedMesh, load_pieces, load_shape
from artigen.datasets.part_labels import SPLIT_LABELS, SPLIT_WORDS, find_word, guess_label
from artigen.datasets.partnet_annotation import SourceNode, SourcePiece, read_json
from artigen.datasets.partnet_joints import RestPose, closed_pose, describe_rest, swings_both_ways
from artigen.datasets.partnet_meshes import PieceMesh
from artigen.datasets.partnet_mobility import find_rest_poses
from artigen.datasets.partnet_parts import order_nodes
from artigen.datasets.source_object import (
    ReaderConfig,
    SourceObject,
    SourceTree,
    assemble,
    collect_corners,
)
from artigen.datasets.units import SHARE, guess_unit, scale_meshes
from artigen.errors import SourceError
from artigen.types import PartLabel

logger = logging.getLogger(__name__)

CLOSED_SHARE = 0.02
"""A limit within this share of the range from 0 is the closed end, because URDFs are modelled closed."""
MOST_JOINTS = 300
MOST_SHAPES = 5_000
"""An object has no more of them; a scene or a fault of a script has."""
PACKAGE_FILE = "package.xml"
OTHER = "other"


def read_mechanism(
    found: Mechanism, scratch: Path, cfg: ReaderConfig | None = None, *, name: str = ""
) -> SourceObject:
    """Reads the meshes of a mechanism and makes parts of its links.

    Args:
        scratch: Folder for converted meshes, needed until the package is written.
        name: Name of the object; default: that of the file.

    Raises:
        SourceError: If the object is invalid; names the file, the element, its value and what is allowed.
    """
    cfg, path = cfg or ReaderConfig(), found.path
    moving, shapes = sum(joint.type in MOVING for joint in found.joints), len(found.visuals)
    if moving > MOST_JOINTS or shapes > MOST_SHAPES:
        raise SourceError(
            f"{path}: holds {moving:,} moving joints and {shapes:,} visuals, at most {MOST_JOINTS:,} and "
            f"{MOST_SHAPES:,} are kept: choose a part of it, or join visuals that move together"
        )
    tree = build_tree(found, path)
    pieces, notes = read_shapes(found, tree, path, scratch)
    tree, empty_notes = _keep_drawn(tree, {piece.node for piece in pieces}, path)
    nodes = tuple(order_nodes(tree.nodes))
    up, front = cfg.up or found.frame[0], cfg.front or found.frame[1]
    turn = turn_upright(up, front)
    category, category_note = _find_category(found, path, name, cfg)
    pieces, unit, unit_note = _fit_unit(found, pieces, category)
    corners = collect_corners(pieces)
    _check_area(corners, path)
    labels, label_notes = label_links(tree, nodes, found, corners, turn)
    poses = rest_nodes(tree, nodes, labels, corners)
    said = f"up is {up} and the front faces {front} in the file"
    made = assemble(
        SourceTree(
            nodes=nodes,
            pieces=pieces,
            labels=labels,
            poses=poses,
            T_zup_file=turn,
            follows=tuple((one, other) for one, other in tree.follows.items()),
            joint_names=tree.joint_names,
        ),
        cfg,
        name=name or path.stem,
        category=category,
        choose_size=lambda extents: (cfg.size or unit * float(extents.max()), ()),
        notes=(
            *(note for note in (said, category_note, unit_note) if note),
            *found.notes,
            *tree.notes,
            *notes,
            *empty_notes,
            *label_notes,
            *(pose.note for pose in poses.values() if pose.note),
        ),
    )
    logger.info("%s: %d parts, %d shapes", made.asset.name, len(made.asset.parts), len(made.visuals))
    return made


def _check_area(corners: Mapping[int, np.ndarray], path: Path) -> None:
    """Refuses an object of which no triangle has an area."""
    sides = [points.reshape(-1, 3, 3)[:, 1:] - points.reshape(-1, 3, 3)[:, :1] for points in corners.values()]
    if not any(np.cross(side[:, 0], side[:, 1]).any() for side in sides):
        raise SourceError(f"{path}: none of its triangles has an area, expected a surface")


def _fit_unit(
    found: Mechanism, pieces: tuple[PieceMesh, ...], category: str
) -> tuple[tuple[PieceMesh, ...], float, str]:
    """The pieces, metres per length of all, and a sentence; meshes may be in another unit than joints."""
    corners = np.concatenate([piece.mesh.vertices for piece in pieces]) if pieces else np.zeros((1, 3))
    extents = np.ptp(corners, axis=0)
    unit, note = guess_unit(extents, category)
    if not note:
        return pieces, 1.0, ""
    offsets = [float(np.linalg.norm(joint.T_parent_joint[:3, 3])) for joint in found.joints]
    travels = [abs(end or 0.0) for j in found.joints if j.type == "prismatic" for end in (j.lower, j.upper)]
    if max((*offsets, *travels), default=0.0) > SHARE * float(extents.max()):
        return pieces, unit, note
    return scale_meshes(pieces, unit), 1.0, f"{note}; joints are in metres"


def _find_category(urdf: Mechanism, path: Path, name: str, cfg: ReaderConfig) -> tuple[str, str]:
    """The requested category, that of a ``meta.json`` beside the URDF, or a guess by names; and a note."""
    meta = path.parent / "meta.json"
    value = read_json(meta) if meta.is_file() else None
    said = value.get("model_cat") if isinstance(value, dict) else None
    if cfg.category or (isinstance(said, str) and said):
        return cfg.category or str(said), ""
    return guess_category([name, path.stem, urdf.name, path.resolve().parent.name])


def turn_upright(up: Direction, front: Direction) -> Float[np.ndarray, "4 4"]:
    """The rotation of ``up`` to z and ``front`` to -x.

    Raises:
        SourceError: If both are along one axis.
    """
    if up[-1] == front[-1]:
        raise SourceError(f"up is {up} and the front faces {front}: they lie along one axis, expected two")
    above, ahead = _axis(up), _axis(front)
    T = np.eye(4)
    T[:3, :3] = np.stack([-ahead, np.cross(above, -ahead), above])
    return T


def _axis(direction: Direction) -> np.ndarray:
    return (-1.0 if direction[0] == "-" else 1.0) * np.eye(3)["xyz".index(direction[-1])]


def read_shapes(
    found: Mechanism, tree: Tree, path: Path, scratch: Path
) -> tuple[tuple[PieceMesh, ...], list[str]]:
    """The geometry of every node: its visuals, or its collision shapes if it has none."""
    pieces: list[PieceMesh] = []
    notes, touched, missing = [], [], []
    numbers: dict[tuple[int, str], int] = {}
    drawn, solid = (_group_shapes(shapes, tree) for shapes in (found.visuals, found.collisions))
    for node in tree.nodes:
        own = drawn.get(node.id) or solid.get(node.id, [])
        touched += [node.name] if own and node.id not in drawn else []
        lost = []
        for shape in own:
            placed, why = _load_placed(shape, path, scratch)
            if placed is None:
                lost.append(f"link {shape.link!r}: {why}")
                continue
            missing += placed.missing
            name = _piece_name(shape, leads=shape.link == node.name)
            number = numbers.setdefault((node.id, name), len(numbers))
            pieces.append(_place(found.place(shape), placed, node.id, SourcePiece(id=number, name=name)))
        if lost and len(lost) == len(own):
            raise SourceError(f"{path}: {lost[0]}, and node {node.name!r} has no other geometry")
        notes += [f"{sentence}, and is left out" for sentence in lost]
    if touched:
        notes.append(f"links without visuals show their collision shapes: {', '.join(touched)}")
    if missing:
        names = ", ".join(dict.fromkeys(missing))
        notes.append(f"images and materials that are missing, plain colours instead: {names}")
    return tuple(pieces), notes


def _group_shapes(shapes: Sequence[Shape], tree: Tree) -> dict[int, list[Shape]]:
    """Shapes by node."""
    groups: dict[int, list[Shape]] = {}
    for shape in shapes:
        if shape.link in tree.owners:
            groups.setdefault(tree.owners[shape.link], []).append(shape)
    return groups


def _load_placed(shape: Shape, path: Path, scratch: Path) -> tuple[PlacedMesh | None, str]:
    """The triangles of a shape, or None and the reason."""
    if isinstance(shape, Solid):
        return load_pieces(shape.pieces, scratch), f"shape {shape.name!r} holds no triangles"
    texture = find_mesh(shape.texture, path) if shape.texture else None
    gone = (shape.texture,) if texture is not None and not texture.is_file() else ()
    texture = None if gone else texture
    file, root = None, path.parent
    if shape.kind == "mesh":
        file = find_mesh(shape.file, path)
        if not file.is_file():
            return None, f"mesh {shape.file!r} is missing, looked for at {file}"
        root = _common_root(path, file)
    placed = load_shape(shape, file, root, scratch, texture)
    if placed is None:
        return None, f"mesh {shape.file!r} holds no triangles"
    return replace(placed, missing=(*placed.missing, *gone)), ""


def _piece_name(shape: Shape, *, leads: bool) -> str:
    """``handle``, ``knob`` or ``shelf`` if the visual or its fixed link has that name."""
    for name in (shape.name,) if leads else (shape.name, shape.link):
        label = SPLIT_WORDS.get(find_word(name) or "")
        if label is not None:
            return label
    return OTHER


def _place(T: np.ndarray, placed: PlacedMesh, node: int, piece: SourcePiece) -> PieceMesh:
    mesh = replace(placed.mesh, vertices=placed.mesh.vertices @ T[:3, :3].T + T[:3, 3])
    return PieceMesh(node=node, piece=piece, path=placed.path, mesh=mesh, T_tree_file=T, scale=placed.scale)


def find_mesh(name: str, urdf: Path) -> Path:
    """Path of a file that a URDF names: the first one that exists, else the first candidate.

    ``package://`` and ``model://`` paths are looked up in all folders above the URDF, with and without the
    package's name; no path may leave the folder in which it is looked up. Other paths may not leave the
    package: the folder with ``package.xml``, however far up, else the one above the URDF's folder. Where the
    URDF is a link, as in the cache of Hugging Face, files are looked up beside both.

    Raises:
        SourceError: If the path leaves the package.
    """
    name = name.replace("\\", "/")
    scheme, _, rest = name.rpartition("://")
    written, target = urdf.parent.absolute(), urdf.resolve().parent
    chains = [
        [folder, *folder.parents][:-1] for folder in dict.fromkeys((written, written.resolve(), target))
    ]
    places: list[tuple[Path, Path]] = []
    for above in chains:
        if scheme in ("package", "model"):
            package, _, inner = rest.partition("/")
            places += [(folder, folder / inner) for folder in above if folder.name == package]
            places += [(folder, folder / rest) for folder in above]
            places += [(folder, folder / inner) for folder in above]
        else:
            nearby = above[min(1, len(above) - 1)]
            root = next((folder for folder in above if (folder / PACKAGE_FILE).is_file()), nearby)
            places.append((root, above[0] / rest))
    stored = [target] if urdf.is_symlink() else []
    safe = [place for root, place in places if _stays_in(place, (root, *stored))]
    there = [place for _, place in places if place.is_file()]
    found = next((place for place in there if place in safe), (there or safe or [None])[0])
    if scheme not in ("", "file", "package", "model") or found not in safe:
        raise SourceError(
            f"{urdf}: names file {name!r}, expected a path inside of {places[0][0]}, relative or with package://"
        )
    return found


def _stays_in(place: Path, folders: Sequence[Path]) -> bool:
    """Whether a path lies in one of some folders, both as written and with links followed."""
    written, real = Path(os.path.normpath(place)), place.resolve()
    return any(real.is_relative_to(folder.resolve()) for folder in folders) and (
        written.is_relative_to(folders[0]) or real.is_relative_to(folders[0].resolve())
    )


def _common_root(urdf: Path, file: Path) -> Path:
    """The common folder of a URDF and a mesh, in which materials and images are."""
    mesh = file.absolute()
    shared = (folder for folder in urdf.absolute().parents if mesh.is_relative_to(folder))
    return next(shared, Path(mesh.anchor))


def _keep_drawn(tree: Tree, drawn: set[int], path: Path) -> tuple[Tree, list[str]]:
    """Drops links without geometry that carry nothing; refuses others."""
    notes = []
    nodes = list(tree.nodes)
    while empty := [node for node in nodes if node.id not in drawn]:
        leaves = [node for node in empty if not any(other.parent == node.id for other in nodes)]
        if not leaves or leaves[0].parent == -1:
            node = (leaves or empty)[0]
            carried = [other.name for other in nodes if other.parent == node.id]
            what = "the body" if node.parent == -1 else "a link between two joints"
            raise SourceError(
                f"{path}: link {node.name!r} is {what} and has no geometry, but carries "
                f"{', '.join(carried) or 'nothing'}; every part needs a visual or collision shape"
            )
        notes.append(f"link {leaves[0].name!r} has no geometry and is left out")
        nodes.remove(leaves[0])
    kept = {node.id for node in nodes}
    follows = {one: other for one, other in tree.follows.items() if {one, other} <= kept}
    return replace(tree, nodes=tuple(nodes), follows=follows), notes


def label_links(
    tree: Tree,
    nodes: Sequence[SourceNode],
    urdf: Mechanism,
    corners: Mapping[int, np.ndarray],
    T_zup_file: np.ndarray,
) -> tuple[dict[int, PartLabel], list[str]]:
    """Labels of all nodes by id: by words in the names of link, joint and visuals, else by the joint."""
    labels: dict[int, PartLabel] = {}
    said = []
    for node in nodes:
        if node.parent == -1:
            labels[node.id] = "base"
            continue
        if node.name in urdf.labels:
            labels[node.id] = urdf.labels[node.name]
            continue
        visuals = [shape for shape in urdf.visuals if tree.owners.get(shape.link) == node.id]
        plain = [shape.name for shape in visuals if _piece_name(shape, leads=True) not in SPLIT_LABELS]
        names = (node.name, tree.joint_names[node.id], *plain, *(shape.name for shape in visuals))
        labels[node.id], why = guess_label(node, names, corners, labels, T_zup_file)
        said.append(f"{node.name} is a {labels[node.id]} ({why})")
    return labels, [f"labels: {'; '.join(said)}"] if said else []


def rest_nodes(
    tree: Tree,
    nodes: Sequence[SourceNode],
    labels: Mapping[int, PartLabel],
    corners: Mapping[int, np.ndarray],
) -> dict[int, RestPose]:
    """Closed pose of every node: the limit at 0, else as for PartNet; followers close with their leader."""
    poses = find_rest_poses(nodes, labels, corners, _find_rest)
    for one, other in tree.follows.items():
        node, leader = (next(n for n in nodes if n.id == number) for number in (one, other))
        share = (poses[other].rest - leader.a) / (leader.b - leader.a)
        rest = node.a + share * (node.b - node.a)
        share = (poses[other].far - leader.a) / (leader.b - leader.a)
        far = node.a + share * (node.b - node.a)
        poses[one] = RestPose(rest=rest, far=far, note=f"link {node.name!r} follows {leader.name!r}")
    return poses


def _find_rest(node: SourceNode, label: PartLabel, points: np.ndarray, body: np.ndarray) -> RestPose:
    """The limit at 0; else 0 if a limit is near and the part does not stand off more than there; else as for
    PartNet."""
    near, far = sorted((node.a, node.b), key=abs)
    if abs(near) <= CLOSED_SHARE * abs(node.b - node.a):
        return RestPose(rest=near, far=far, note=describe_rest(node, near, far))
    beyond = node.a * node.b < 0.0 and not swings_both_ways(node) and label not in ("knob", "wheel")
    return closed_pose(node, label, points, body, first=(0.0,) if beyond else ())
