"""Other looks on the meshes of a package, whose geometry stays as it is."""

from collections.abc import Mapping
from dataclasses import replace

from artigen.shapes.surfaces.finishes import Finish
from sim_export.appearance.dress import Look, find_looks
from sim_export.errors import PackageError
from sim_export.package import Mesh, SimPackage, Visual


def restyle_package(package: SimPackage, finishes: Mapping[str, Finish]) -> SimPackage:
    """The package in other finishes.

    Visuals of a finish that is not given keep their look, and so do those of which only one look is clear.

    Args:
        package: A package whose visuals show finishes (`Visual.finish`).
        finishes: Finishes by role.

    Raises:
        PackageError: If no visual shows one of the finishes.
    """
    shown = {visual.finish for link in package.links for visual in link.visuals}
    known = {role: finish for role, finish in finishes.items() if role in shown}
    if not known:
        seen = ", ".join(sorted(shown - {""})) or "none"
        raise PackageError(
            f"package {package.name!r}: its visuals show the finishes {seen}, "
            f"expected some of {', '.join(sorted(finishes))}; only drawn objects with exact visuals have them"
        )
    looks = find_looks(known)
    kept = {
        visual.mesh.material.name
        for link in package.links
        for visual in link.visuals
        if isinstance(visual.mesh, Mesh) and not _changes(visual, looks)
    }
    looks = {role: _rename(look, kept) for role, look in looks.items()}
    links = tuple(
        replace(link, visuals=tuple(_dress(visual, looks) for visual in link.visuals))
        for link in package.links
    )
    return replace(package, links=links)


def _changes(visual: Visual, looks: Mapping[str, Look]) -> bool:
    look = looks.get(visual.finish)
    if look is None or not isinstance(visual.mesh, Mesh) or visual.mesh.uv is None:
        return False
    return (visual.mesh.material.opacity < 1.0) == (look.material.opacity < 1.0)


def _dress(visual: Visual, looks: Mapping[str, Look]) -> Visual:
    if not _changes(visual, looks):
        return visual
    assert isinstance(visual.mesh, Mesh)
    return replace(visual, mesh=looks[visual.finish].put_on(visual.mesh))


def _rename(look: Look, taken: set[str]) -> Look:
    """The look under a name that no kept material has."""
    name, number = look.material.name, 1
    while name in taken:
        number += 1
        name = f"{look.material.name}_{number}"
    return replace(look, material=replace(look.material, name=name))
