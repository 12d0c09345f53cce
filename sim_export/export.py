"""`export_asset`: the sequence of stages from an `Asset` to a `SimPackage`."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from artigen.files.wavefront import ObjText
from artigen.runtime.budget import Budget
from artigen.runtime.stopwatch import Stopwatch
from artigen.types import Asset
from sim_export.appearance.splats import attach_splats
from sim_export.appearance.texture import bake_parts
from sim_export.collision.attachment import attach_links
from sim_export.collision.clearance import clear_joints
from sim_export.collision.exact import find_solids
from sim_export.collision.feet import add_feet, level_object
from sim_export.collision.hull_limits import THICKEST, compact_hull, flatten_links
from sim_export.collision.pins import pin_carriers
from sim_export.collision.recovery import recover_hulls, recover_surface
from sim_export.collision.tools import decompose
from sim_export.collision.trimming import fill_meshes, trim_meshes
from sim_export.geometry.occupancy import require_voxels
from sim_export.geometry.struts import brace_links
from sim_export.geometry.triangles import diagonal_of
from sim_export.motion.held_drawers import keep_drawers_held
from sim_export.motion.requirements import find_crossings, find_requirements
from sim_export.package import Hull, Link, Mesh, SimPackage, SourceMesh, Visual
from sim_export.physics.annotations import annotate_handles
from sim_export.physics.links import (
    LinkTree,
    PartGeometry,
    build_links,
    link_names,
    link_owners,
    link_surfaces,
)
from sim_export.physics.masses import hold_centers
from sim_export.physics.materials import part_material
from sim_export.search import HullPlan, judge_package, search_hulls
from sim_export.solids import Solids, make_solids

COVERING = 0.5
"""Share of the budget that is left in which surfaces are covered; the rest is for clearance and checks."""
RECOVERING = 0.1
"""Share of the time for covering in which what cuts took is put back, if no more of it is left."""
LEAST_COVERING = 0.1
"""Share of the whole budget that covering gets, however long reading and mending the object took."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Exported:
    """A package, and the seconds that each stage took. ``unpainted`` has the meshes of all parts that are
    still to be coloured (`paint_package`)."""

    package: SimPackage
    seconds: tuple[tuple[str, float], ...]
    unpainted: Mapping[str, Mesh] = field(default_factory=dict)


def export_asset(
    asset: Asset,
    *,
    provenance: Mapping[str, str] | None = None,
    finish: Callable[[SimPackage], SimPackage] = lambda package: package,
    budget: Budget | None = None,
    first: HullPlan | None = None,
) -> Exported:
    """Converts an articulated object to a simulation package.

    Args:
        asset: Parts, joints and voxels. Its Gaussians, or else its surface samples, colour the textures;
            Gaussians are also added to the package per link.
        provenance: Origin of the object, for ``provenance.json``.
        finish: Completes each package before its hulls are judged (`export_best`).
        budget: As in `export_best`.
        first: How hulls are made first; by default by us, of the parts' meshes.

    Raises:
        ExportError: If a stage fails; the message names the part, the measured and the allowed value.
    """
    return export_best(
        make_solids(asset),
        first or HullPlan(target="voxels"),
        provenance=provenance,
        finish=finish,
        budget=budget,
    )


def export_best(
    solids: Solids,
    first: HullPlan,
    *,
    source_meshes: Mapping[int, Sequence[SourceMesh]] | None = None,
    provenance: Mapping[str, str] | None = None,
    finish: Callable[[SimPackage], SimPackage] = lambda package: package,
    budget: Budget | None = None,
) -> Exported:
    """The package of an object, with the hulls that fail fewest static checks.

    Hulls are made by one plan, and while they fail checks by others (`search_hulls`). Each package is judged
    as ``finish`` leaves it, and the best is painted. Plans that cannot be carried out are recorded, and so is
    a budget that ended the search.

    Args:
        solids: The parts.
        first: How hulls are made first.
        source_meshes: Visual meshes by part, used instead of those made from the voxels; a part without any
            is invisible. Collision, mass and annotations still come from the voxels.
        provenance: As in `export_asset`.
        finish: Completes each package.
        budget: Time for the search; one package is made in any case.

    Raises:
        ExportError: If no plan can be carried out.
    """
    budget, spent = budget or Budget(), Counter[str](dict(solids.seconds))
    read: dict[Path, ObjText] = {}

    def make(plan: HullPlan) -> tuple[Exported, SimPackage]:
        least = LEAST_COVERING * budget.seconds
        covering = budget.share(COVERING, least) if plan.method == "auto" else budget
        made = export_solids(
            solids, plan, source_meshes=source_meshes, provenance=provenance, budget=covering
        )
        spent.update(dict(made.seconds))
        return made, finish(made.package)

    found = search_hulls(first, make, lambda made: judge_package(made[1], read), budget)
    watch = Stopwatch()
    best, package = found.best
    painted = paint_package(best.package, solids.asset, best.unpainted)
    if painted is not best.package:
        package = finish(painted)
    watch.lap("texture")
    spent.update(dict(watch.laps))
    records = [f"hulls could not be made in one of several ways: {error}" for error in found.errors]
    if budget.cut_short:
        fails = f"fail {', '.join(found.judged.failed)}" if found.judged.failed else "pass their checks"
        records.append(
            f"the budget of {budget.seconds:g} s ended the search for hulls after {found.made} packages; the "
            f"best ones {fails}, and more time may give others (--budget)"
        )
    return Exported(
        package=replace(package, records=(*package.records, *records)), seconds=tuple(spent.items())
    )


def export_solids(
    solids: Solids,
    plan: HullPlan,
    *,
    source_meshes: Mapping[int, Sequence[SourceMesh]] | None = None,
    provenance: Mapping[str, str] | None = None,
    budget: Budget | None = None,
) -> Exported:
    """The package of an object whose parts are solids already; meshes made from voxels are not painted.

    Args:
        solids: The parts.
        plan: How hulls are made.
        source_meshes: As in `export_best`.
        provenance: As in `export_asset`.
        budget: Time for covering the parts with hulls.
    """
    watch = Stopwatch()
    asset, meshes, sheets = solids.asset, solids.meshes, plan.target == "surfaces"
    names, levels = link_names(asset), dict(plan.levels)
    if plan.method != "auto":
        made = _decompose(solids, plan, budget or Budget())
        hulls = [made.get(names.get(index, ""), ()) for index in range(len(meshes))]
    elif sheets:
        made = solids.source_cover.make_hulls(levels, fewer=plan.fewer, budget=budget)
        hulls = [made.get(names.get(index, ""), ()) for index in range(len(meshes))]
    else:
        owners = zip(asset.parts, link_owners(asset), strict=True)
        of_parts = {part.name: levels.get(names[at], 0) for part, at in owners}
        made = solids.voxel_cover.make_hulls(of_parts, fewer=plan.fewer, budget=budget)
        hulls = [made[part.name] for part in asset.parts]
    watch.lap("decompose")
    shown: list[tuple[Mesh | SourceMesh, ...]] = [(mesh,) for mesh in meshes]
    if source_meshes is not None:
        shown = [tuple(source_meshes.get(index, ())) for index in range(len(meshes))]
    geometry = [
        PartGeometry(visuals=visuals, hulls=own, inertial=inertial)
        for visuals, own, inertial in zip(shown, hulls, solids.inertials, strict=True)
    ]
    tree = build_links(asset, geometry)
    watch.lap("links")
    vertices = {part.name: mesh.vertices for part, mesh in zip(asset.parts, meshes, strict=True)}
    panels = {link.name: vertices[link.parts[0]] for link in tree.links if link.parts}
    joints, held = keep_drawers_held(tree.links, tree.joints, panels)
    needs = find_crossings(tree.links, joints, find_requirements(tree.links, joints))
    watch.lap("requirements")
    cleared = clear_joints(tree.links, joints, needs, sheets=sheets, shares=plan.shares)
    watch.lap("clearance")
    solid = {part.name: mesh for part, mesh in zip(asset.parts, meshes, strict=True)}
    if sheets:
        whole = budget or Budget()
        recovering = whole.share(1.0, RECOVERING * whole.seconds)
        links, recovered = recover_hulls(tree.links, cleared.links, cleared.joints, needs, recovering)
    else:
        links, recovered = recover_surface(cleared.links, cleared.joints, needs, solid)
    watch.lap("recover")
    links, footed = add_feet(flatten_links(links), cleared.joints, needs, solid)
    attached = attach_links(links, cleared.joints, needs)
    seen = solids.surfaces or [mesh.vertices[mesh.faces] for mesh in meshes]
    base = np.concatenate(
        [own for part, own in zip(asset.parts, seen, strict=True) if part.name in tree.links[-1].parts]
    )
    levelled = level_object(attached.links, cleared.joints, needs, asset.category, base)
    watch.lap("attach")
    held_links, centered = hold_centers(levelled.links)
    tree = LinkTree(links=held_links, joints=cleared.joints, records=tree.records)
    handles = annotate_handles(asset, meshes, tree)
    watch.lap("annotate")
    trimmed: tuple[str, ...] = ()
    unpainted: dict[str, Mesh] = {}
    if source_meshes is None:
        cell = asset.scale / require_voxels(asset).resolution
        solid, filled = fill_meshes(tree.links, solid, cell)
        solid, cut = trim_meshes(tree.links, tree.joints, needs, solid)
        unpainted, braced = brace_links(tree.links, solid, cell)
        trimmed = (*filled, *cut, *braced)
        tree = replace(tree, links=_show_meshes(tree.links, unpainted))
    if asset.gaussians is not None:
        tree = replace(tree, links=attach_splats(tree.links, asset))
    tree = replace(tree, links=_show_more(tree.links, (*attached.visuals, *levelled.feet)))
    watch.lap("trim")
    records = (
        *asset.notes,
        *solids.records,
        *tree.records,
        *held,
        *cleared.records,
        *recovered,
        *footed,
        *attached.records,
        *levelled.records,
        *centered,
        *trimmed,
    )
    package = SimPackage(
        name=asset.name,
        category=asset.category,
        visual="voxels" if source_meshes is None else "source",
        links=pin_carriers(tree.links, tree.joints),
        joints=tree.joints,
        handles=handles,
        requires_open=needs,
        materials=tuple((part.name, part_material(part.label, asset.category)) for part in asset.parts),
        provenance=tuple(sorted((provenance or {}).items())),
        records=records,
    )
    return Exported(package=package, seconds=tuple(watch.laps), unpainted=unpainted)


def _decompose(solids: Solids, plan: HullPlan, budget: Budget) -> dict[str, tuple[Hull, ...]]:
    """Hulls of every link by a method that is not ours, within the limits of engines."""
    surfaces = solids.surfaces or [mesh.vertices[mesh.faces] for mesh in solids.meshes]
    shown = link_surfaces(solids.asset, surfaces)
    thickest = THICKEST * diagonal_of(np.concatenate(list(shown.values())).reshape(-1, 3))
    out = {}
    for name, triangles in shown.items():
        if plan.method == "exact":
            found = find_solids(triangles, name)
        else:
            assert plan.method != "auto"
            found = decompose(plan.method, triangles, dict(plan.options), budget.left, name)
        out[name] = tuple(part for hull in found for part in compact_hull(hull, thickest))
    return out


def paint_package(package: SimPackage, asset: Asset, unpainted: Mapping[str, Mesh]) -> SimPackage:
    """The package with textures on the meshes of all parts, in the colours of the asset, and records of how
    well these cover them; without colours or meshes, the package as it is."""
    if not unpainted or (asset.surface is None and asset.gaussians is None):
        return package
    baked = bake_parts(asset, [unpainted[part.name] for part in asset.parts])
    painted = {part.name: mesh for part, mesh in zip(asset.parts, baked.meshes, strict=True)}
    return replace(
        package,
        links=_show_meshes(package.links, painted, instead_of=unpainted),
        records=(*package.records, *baked.records),
    )


def _show_more(links: Sequence[Link], more: Sequence[Visual]) -> tuple[Link, ...]:
    """Links that show further visuals of their parts."""
    return tuple(
        replace(link, visuals=(*link.visuals, *(visual for visual in more if visual.part in link.parts)))
        for link in links
    )


def _show_meshes(
    links: Sequence[Link], meshes: Mapping[str, Mesh], instead_of: Mapping[str, Mesh] | None = None
) -> tuple[Link, ...]:
    """Links that show one mesh for each part, instead of all others or only of the given ones."""

    def show(visual: Visual) -> Visual:
        kept = instead_of is not None and visual.mesh is not instead_of.get(visual.part)
        return visual if kept else replace(visual, mesh=meshes[visual.part])

    return tuple(replace(link, visuals=tuple(map(show, link.visuals))) for link in links)
