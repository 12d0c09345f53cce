"""`build_reference`: the exact package of a `Shape`.

Collision consists of the object's convex primitives, simplified to boxes and cylinders within a tolerance.
Visuals are the exact unions of each part's primitives, one mesh per finish, with tiles of the finish in
metres. Joints and opening order are those of the object.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from artigen.kind import Make, MaterialName, find_kind
from artigen.shapes.asset import frame_shape, shape_to_asset
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import FinishKind
from artigen.shapes.surfaces.textures import PaintTable, find_rows, make_paint
from sim_export.appearance.dress import Look, find_looks
from sim_export.appearance.pieces import Piece, draw_pieces, find_pieces
from sim_export.appearance.prints import FINISHES, find_prints
from sim_export.appearance.splats import attach_splats
from sim_export.appearance.tiles import lay_coordinates
from sim_export.collision.hull_limits import trim_hull
from sim_export.collision.pins import pin_carriers
from sim_export.collision.simplification import EXACT, measure_simplified, simplify_links
from sim_export.geometry.broken_edges import is_box
from sim_export.geometry.needles import flip_needles
from sim_export.geometry.solids import as_solid, solid_arrays, unite
from sim_export.geometry.triangles import bounds_of, find_slivers, triangle_normals
from sim_export.package import Hull, Inertial, Mesh, Requirement, SimPackage
from sim_export.physics.annotations import annotate_handles
from sim_export.physics.followers import couple_followers
from sim_export.physics.inertia import combine, mesh_inertial
from sim_export.physics.links import LinkTree, PartGeometry, build_links, link_owners
from sim_export.physics.makes import fill_base, find_make, is_hardware, wall_density
from sim_export.physics.masses import mean_thickness, subtract
from sim_export.physics.materials import MATERIALS, finish_material
from sim_export.topology import hull_kinds

BESIDE = 0.2
"""Cosine between a normal and a side above which a broken edge is one of that side."""
SQUARE = 0.9
"""Cosine to the sides of a box below which a face is a broken edge."""
SLIVERS = 0.01
"""Share of triangles that may be slivers in a union, as V101 allows; one always may."""


@dataclass(frozen=True, kw_only=True)
class ReferenceConfig:
    """What a reference package contains."""

    detail: Literal["low", "high"] = "high"
    """``high``: rounds are smooth and edges broken; ``low``: visuals are the primitives as they collide."""
    gaussians: bool = False
    """Whether links have 3D Gaussians, discs on their exact faces (`artigen.splats.faces`)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Union:
    """The closed surface of a part, and the primitive of each face."""

    mesh: Mesh
    owners: Int[np.ndarray, "F"]


def build_reference(
    shape: Shape, cfg: ReferenceConfig | None = None, *, provenance: Mapping[str, str] | None = None
) -> SimPackage:
    """Builds the exact package of a shape, in metres about the centre of the closed object.

    Args:
        shape: The object.
        cfg: What is in it.
        provenance: Origin of the object, for ``provenance.json``.

    Raises:
        ExportError: If a part cannot be a link or has no mass; the message names the part.
    """
    cfg = cfg or ReferenceConfig()
    center, _ = frame_shape(shape)
    asset = shape_to_asset(shape, resolution=None)
    finishes = dict(shape.finishes)
    kind = find_kind(shape.category)
    boards = kind is not None and kind.trade == "furniture"
    printed = kind is not None and kind.trade == "appliance" and cfg.detail == "high"
    prints = find_prints(shape) if printed else {}
    table, looks = make_paint(shape), find_looks(finishes | (dict(FINISHES) if prints else {}))
    first = np.cumsum([0, *(len(part.primitives) for part in shape.parts)])
    make = find_make(shape.category, shape.style)
    geometry, meshes, records = [], [], []
    materials: list[tuple[str, str]] = []
    for part, start, solids, simple in zip(shape.parts, first, *_collide(shape, center), strict=False):
        if cfg.detail == "low":
            pieces = draw_pieces(part.primitives, center)
        else:
            pieces = find_pieces(part.primitives, finishes, center, boards=boards)
        union = _show(pieces)
        meshes.append(union.mesh)
        dressed = _dress(union, part, table, int(start), center, looks)
        for finish, mesh in prints.get(part.name, {}).items():
            dressed[finish] = looks[finish].put_on(replace(mesh, vertices=mesh.vertices - center))
        apart = [far for far in measure_simplified(solids, simple) if far > EXACT]
        if apart:
            most = np.ceil(1e4 * max(apart)) / 10
            records.append(
                f"{part.name}: {len(apart)} of {len(solids)} hulls are boxes or cylinders that differ from "
                f"the part by at most {most:g} mm"
            )
        hulls = _trim(simple)
        if len(hulls) > len(simple):
            records.append(f"{part.name}: {len(simple)} primitives cut to {len(hulls)} hulls, being oblong")
        made_of = _materials(shape, part)
        materials.append((part.name, Counter(sorted(made_of)).most_common(1)[0][0]))
        inertial = _weigh(part, solids, made_of, make)
        geometry.append(
            PartGeometry(
                visuals=tuple(dressed.values()),
                finishes=tuple(dressed),
                hulls=hulls,
                inertial=inertial,
                visual_error=max(piece.deviation for piece in pieces),
            )
        )
    tree = _couple(shape, build_links(asset, geometry, find_latched(shape), find_stays(shape)))
    links = pin_carriers(tree.links, tree.joints)
    if cfg.gaussians:
        from artigen.splats.faces import lay_gaussians

        discs = lay_gaussians(shape)
        records.append(f"{len(discs.means)} Gaussians are discs on the exact faces")
        links = attach_splats(links, replace(asset, gaussians=discs))
    return SimPackage(
        name=asset.name,
        category=asset.category,
        visual="exact",
        links=links,
        joints=tree.joints,
        handles=annotate_handles(asset, meshes, tree),
        requires_open=_requirements(shape, tree),
        materials=tuple(materials),
        provenance=tuple(sorted((provenance or {}).items())),
        records=(*records, *tree.records),
    )


def weigh_shape(shape: Shape) -> float:
    """Mass (kg) of an object without making its package, in which very light links are heavier."""
    make = find_make(shape.category, shape.style)
    return sum(
        _weigh(part, _solids(part, np.zeros(3)), _materials(shape, part), make).mass for part in shape.parts
    )


def describe_build(shape: Shape) -> list[object]:
    """Topology of an object's package, without making the package."""
    return [
        (
            part.name,
            part.label,
            part.parent,
            None if part.joint is None else part.joint.type,
            hull_kinds(_trim(simple)),
        )
        for part, simple in zip(shape.parts, _collide(shape, np.zeros(3))[1], strict=True)
    ]


def _solids(part: ShapePart, center: Float[np.ndarray, "3"]) -> list[Hull]:
    return [
        Hull(vertices=place_vertices(primitive) - center, faces=primitive.faces)
        for primitive in part.primitives
    ]


def _collide(shape: Shape, center: Float[np.ndarray, "3"]) -> tuple[list[list[Hull]], list[tuple[Hull, ...]]]:
    """The exact solids of every part, and the simpler ones that collide."""
    solids = [_solids(part, center) for part in shape.parts]
    return solids, simplify_links(solids, link_owners(shape_to_asset(shape, resolution=None)))


def _trim(solids: Sequence[Hull]) -> tuple[Hull, ...]:
    return tuple(piece for solid in solids for piece in trim_hull(solid))


def _show(pieces: Sequence[Piece]) -> _Union:
    """The surface of a part: the exact union of its pieces if that is a clean mesh, else overlapping closed
    pieces.

    Unions of crossing wires and of nearly aligned boards have slivers and vertices closer than the precision
    of files. Then round pieces stay separate and, if necessary, all pieces do.
    """
    boards = [piece for piece in pieces if not piece.is_round]
    alone = [[piece] for piece in pieces if piece.is_round]
    every = [[piece] for piece in pieces]
    for groups in ([list(pieces)], [boards, *alone], every):
        union = _join([_unite_pieces(group) for group in groups if group])
        if _is_clean(union.mesh):
            break
    return union


def _unite_pieces(pieces: Sequence[Piece]) -> _Union:
    """The union of pieces as one closed mesh, and the primitive of each face."""
    number = {piece.solid.original_id(): piece for piece in pieces}
    # No simplify(): it loses volume where bevelled boards meet.
    mesh = unite([piece.solid for piece in pieces]).to_mesh64()
    runs = np.diff(np.asarray(mesh.run_index).astype(np.int64)) // 3
    vertices = np.asarray(mesh.vert_properties)[:, :3]
    faces = np.asarray(mesh.tri_verts).astype(np.int64)
    middles, starts = vertices[faces].mean(axis=1), np.cumsum([0, *runs])
    owners = [
        number[int(original)].owners(middles[start : start + run])
        for original, start, run in zip(mesh.run_original_id, starts, runs, strict=False)
    ]
    own = np.concatenate(owners)
    return _Union(mesh=Mesh(vertices=vertices, faces=flip_needles(vertices, faces, own)), owners=own)


def _unite(solids: Sequence[Hull]) -> Mesh:
    """The union of convex solids as one closed mesh."""
    vertices, faces = solid_arrays(unite([as_solid(solid) for solid in solids]))
    return Mesh(vertices=vertices, faces=faces)


def _join(unions: Sequence[_Union]) -> _Union:
    """Several surfaces as one."""
    starts = np.cumsum([0, *(len(union.mesh.vertices) for union in unions)])
    vertices = np.concatenate([union.mesh.vertices for union in unions])
    faces = [union.mesh.faces + start for union, start in zip(unions, starts, strict=False)]
    owners = np.concatenate([union.owners for union in unions])
    return _Union(mesh=Mesh(vertices=vertices, faces=np.concatenate(faces)), owners=owners)


def _is_clean(mesh: Mesh) -> bool:
    """Whether there are few slivers and no edges below the precision of files, a micrometre."""
    triangles = mesh.vertices[mesh.faces]
    shortest = np.abs(triangles - np.roll(triangles, -1, axis=1)).max(axis=2).min()
    slivers = np.count_nonzero(find_slivers(triangles, 1.1e-4))
    return bool(shortest > 2e-6 and slivers <= np.ceil(SLIVERS * len(triangles)))


def _dress(
    union: _Union,
    part: ShapePart,
    table: PaintTable,
    start: int,
    center: Float[np.ndarray, "3"],
    looks: Mapping[str, Look],
) -> dict[str, Mesh]:
    """The surface of a part by finish, with texture coordinates in metres; together the meshes are closed."""
    triangles = union.mesh.vertices[union.mesh.faces]
    rows = find_rows(table, start + union.owners, _square_normals(part, union, triangle_normals(triangles)))
    names = [
        name
        for primitive in part.primitives
        for name in (primitive.finish, primitive.lining or primitive.finish)
    ]
    shown = np.array(names)[rows - 2 * start]
    uv = lay_coordinates(triangles + center, rows, table)
    dressed: dict[str, Mesh] = {}
    for name in dict.fromkeys(names):
        own = shown == name
        if own.any():
            used, faces = np.unique(union.mesh.faces[own], return_inverse=True)
            bare = Mesh(vertices=union.mesh.vertices[used], faces=faces.reshape(-1, 3), uv=uv[own])
            dressed[name] = looks[name].put_on(bare)
    return dressed


def _square_normals(
    part: ShapePart, union: _Union, normals: Float[np.ndarray, "F 3"]
) -> Float[np.ndarray, "F 3"]:
    """Normals by which a lining is found: broken edges of boxes belong to the side without it, or with it
    where it is the band on an edge of a board."""
    squared = normals.copy()
    for index, primitive in enumerate(part.primitives):
        if primitive.lined_side is not None and is_box(primitive):
            own, side = union.owners == index, np.array(primitive.lined_side)
            bevel = np.flatnonzero(own)[np.abs(normals[own] @ primitive.rotation).max(axis=1) < SQUARE]
            deep = float(np.abs(primitive.rotation.T @ side) @ primitive.size)
            band = (normals[bevel] @ side > BESIDE) & (deep > primitive.size.min() + 1e-9)
            squared[bevel] = np.where(band[:, None], side, 0.0)
    return squared


def _materials(shape: Shape, part: ShapePart) -> list[MaterialName]:
    """Material of every primitive of a part."""
    kinds: dict[str, FinishKind] = {name: finish.kind for name, finish in shape.finishes}
    return [
        finish_material(kinds[primitive.finish], part.label, shape.category, tuple(primitive.size.tolist()))
        for primitive in part.primitives
    ]


def _weigh(part: ShapePart, solids: Sequence[Hull], made_of: Sequence[MaterialName], make: Make) -> Inertial:
    """Mass properties of the union; volume shared by two materials goes to the first by name.

    Hardware has the density of its material, other parts that of the category's `Make`.
    """
    hardware = is_hardware(part.label, moves=part.joint is not None)
    names = sorted(set(made_of))
    inertials: list[Inertial] = []
    before: Mesh | None = None
    for count, name in enumerate(names, start=1):
        chosen = [solid for solid, made in zip(solids, made_of, strict=True) if made in names[:count]]
        mesh = _unite(chosen)
        density = MATERIALS[name].bulk if hardware else wall_density(make, name)
        if name in make.wall and not hardware:
            own = [solid for solid, made in zip(solids, made_of, strict=True) if made == name]
            density = wall_density(make, name, mean_thickness(_unite(own)))
        added = mesh_inertial(mesh, density)
        known = None if before is None else mesh_inertial(before, density)
        before = mesh
        if known is None:
            inertials.append(added)
        elif added.mass > (1.0 + 1e-6) * known.mass:  # else it is inside the others
            inertials.append(subtract(added, known))
    drawn = combine(inertials)
    if part.parent is not None:
        return drawn
    points = np.concatenate([solid.vertices for solid in solids])
    return fill_base(make, drawn, bounds_of(points))


def _couple(shape: Shape, tree: LinkTree) -> LinkTree:
    """Adds followers, which mimic their leaders, and springs to the tree; one record for each."""
    motions = {part.name: part.joint for part in shape.parts if part.joint is not None}
    leading = {link.name: link.parts[0] for link in tree.links if link.parts}
    joints, records = [], list(tree.records)
    for joint in tree.joints:
        motion = motions.get(leading.get(joint.child, ""))
        if motion is not None and motion.spring > 0.0:
            joint = replace(joint, spring=motion.spring)
            records.append(
                f"{joint.name}: a spring closes it with {joint.spring:g}, at its upper limit with twice that "
                f"(N or N m); URDF cannot say so"
            )
        joints.append(joint)
    follows = {name: motion.follows for name, motion in motions.items() if motion.follows is not None}
    coupled, said = couple_followers(tree.links, joints, follows)
    return replace(tree, joints=coupled, records=(*records, *said))


def find_latched(shape: Shape) -> frozenset[str]:
    """Parts that a latch holds shut: they require a part that they carry to be moved first."""
    parents = {part.name: part.parent for part in shape.parts}

    def carriers(name: str | None) -> Iterator[str]:
        while name is not None:
            yield name
            name = parents[name]

    return frozenset(
        part.name for part in shape.parts if any(part.name in carriers(need.part) for need in part.needs)
    )


def find_stays(shape: Shape) -> frozenset[str]:
    """Parts whose hinges hold them wherever they are left."""
    return frozenset(part.name for part in shape.parts if part.joint is not None and part.joint.stays)


def _requirements(shape: Shape, tree: LinkTree) -> tuple[Requirement, ...]:
    """Opening order: the joints that each joint requires open."""
    driving = {link.parts[0]: link.name.replace("link", "joint") for link in tree.links if link.parts}
    return tuple(
        Requirement(joint=driving[part.name], needs=driving[need.part], fraction=need.fraction)
        for part in shape.parts
        for need in part.needs
        if part.joint is not None
    )
