"""Assigns mesh files to annotated pieces and reads their triangles.

``result.json`` decides if it exists; otherwise the number in the URDF visual's name (``handle-12``);
otherwise the link of the visual. Every deviation becomes a note.
"""

import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float

from artigen.datasets.mechanism import Mechanism
from artigen.datasets.partnet_annotation import SourceNode, SourcePiece
from artigen.errors import SourceError
from artigen.files.inside import inside
from artigen.files.urdf import UrdfShape
from artigen.files.wavefront import ObjMesh, read_obj

MESH_FOLDER = "textured_objs"


@dataclass(frozen=True, kw_only=True, eq=False)
class PieceMesh:
    """One mesh file and its annotated piece; ``p_tree = T_tree_file * (scale * p_file)``.

    ``mesh`` is already in the frame of the joints.
    """

    node: int
    piece: SourcePiece
    path: Path
    mesh: ObjMesh
    T_tree_file: Float[np.ndarray, "4 4"] = field(default_factory=lambda: np.eye(4))
    scale: float = 1.0

    @property
    def visual_name(self) -> str:
        """The name of this visual in PartNet's URDF."""
        return f"{self.piece.name}-{self.piece.id}"


@dataclass(frozen=True, kw_only=True)
class _Reference:
    node: int
    piece: SourcePiece
    path: Path
    in_urdf: bool


def read_pieces(
    folder: Path,
    nodes: tuple[SourceNode, ...],
    live: frozenset[int],
    urdf: Mechanism,
    files: dict[int, tuple[str, ...]],
) -> tuple[tuple[PieceMesh, ...], tuple[str, ...]]:
    """Reads every mesh of the live nodes; returns them with notes on missing files.

    Args:
        nodes: All nodes, including junk, so that meshes of junk are not assigned to other nodes.
        live: Ids of the nodes to read.
        files: Mesh names by annotated id, from result.json; empty without one.

    Raises:
        SourceError: If a mesh is malformed or outside the folder, or all files of a node that the URDF draws
            are missing.
    """
    references, notes = _collect(folder, nodes, urdf, files)
    pieces: list[PieceMesh] = []
    missing: Counter[int] = Counter()
    dangling: dict[int, Path] = {}
    for reference in (reference for reference in references if reference.node in live):
        mesh = read_obj(reference.path, folder) if reference.path.is_file() else None
        if mesh is None or len(mesh.faces) == 0:
            missing[reference.node] += 1
            if reference.in_urdf:
                dangling[reference.node] = reference.path
            continue
        pieces.append(PieceMesh(node=reference.node, piece=reference.piece, path=reference.path, mesh=mesh))
    drawn = Counter(piece.node for piece in pieces)
    for node in (node for node in nodes if node.id in live):
        if drawn[node.id] == 0 and node.id in dangling:
            raise SourceError(
                f"{folder / 'mobility.urdf'}: node {node.id} ({node.name}) has no geometry: "
                f"{dangling[node.id]} is missing or empty, and so are its other files"
            )
        if drawn[node.id] and missing[node.id]:
            total = missing[node.id] + drawn[node.id]
            notes.append(
                f"node {node.id} ({node.name}): {missing[node.id]} of {total} mesh files are missing or empty"
            )
    images = sorted({m.missing for piece in pieces for m in piece.mesh.materials if m.missing})
    if images:
        notes.append(f"{len(images)} images are missing, plain colours used: {', '.join(images)}")
    return tuple(pieces), tuple(notes)


def _collect(
    folder: Path, nodes: tuple[SourceNode, ...], urdf: Mechanism, files: dict[int, tuple[str, ...]]
) -> tuple[list[_Reference], list[str]]:
    by_id = {piece.id: (node, piece) for node in nodes for piece in node.pieces}
    by_name = {
        name: by_id[number] for number, names in sorted(files.items()) if number in by_id for name in names
    }
    known = {node.id: node for node in nodes}
    above = {joint.child: joint.parent for joint in urdf.joints}
    found: dict[Path, _Reference] = {}
    notes, homeless = [], []
    for visual in (visual for visual in urdf.elements if visual.kind == "mesh"):
        path = inside(folder, folder, visual.file, str(folder / "mobility.urdf"))
        owner = (
            by_name.get(path.stem)
            or _owner_by_name(visual.name, by_id)
            or _owner_by_link(visual, above, known)
        )
        if owner is None:
            homeless.append(visual.name or visual.link)
        elif path not in found:
            found[path] = _Reference(node=owner[0].id, piece=owner[1], path=path, in_urdf=True)
    seen = {path.stem for path in found}
    unlisted = 0
    for name, (node, piece) in by_name.items():
        if name not in seen:
            path = inside(folder, folder / MESH_FOLDER, f"{name}.obj", str(folder / "result.json"))
            found[path] = _Reference(node=node.id, piece=piece, path=path, in_urdf=False)
            unlisted += path.is_file()
    if homeless:
        notes.append(
            f"{len(homeless)} visuals belong to no annotated part and were dropped: {', '.join(homeless)}"
        )
    if unlisted:
        notes.append(f"{unlisted} mesh files that the URDF leaves out were added from result.json")
    primitives = [visual.name or visual.link for visual in urdf.elements if visual.kind != "mesh"]
    if primitives:
        notes.append(f"{len(primitives)} visuals without a mesh file were dropped: {', '.join(primitives)}")
    return list(found.values()), notes


def _owner_by_name(
    name: str, by_id: dict[int, tuple[SourceNode, SourcePiece]]
) -> tuple[SourceNode, SourcePiece] | None:
    match = re.fullmatch(r"(.+?)-(\d+)", name)
    owner = by_id.get(int(match[2])) if match else None
    return owner if owner is not None and match is not None and owner[1].name == match[1] else None


def _owner_by_link(
    visual: UrdfShape, above: dict[str, str], known: dict[int, SourceNode]
) -> tuple[SourceNode, SourcePiece] | None:
    """The node of the link, or of its nearest ancestor that has one."""
    link: str | None = visual.link
    while link is not None:
        match = re.fullmatch(r"link_(\d+)", link)
        if match and int(match[1]) in known:
            node = known[int(match[1])]
            stem = re.sub(r"-\d+$", "", visual.name) or "other"
            same = [piece for piece in node.pieces if piece.name == stem]
            return node, same[0] if same else SourcePiece(id=node.id, name=stem)
        link = above.get(link)
    return None
