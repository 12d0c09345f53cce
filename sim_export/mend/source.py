"""The source object for repairs: parts, joints, surfaces, and translations of parts."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from artigen.types import Asset
from sim_export.checks.draft import read_draft
from sim_export.checks.subject import Subject
from sim_export.geometry.hulls import wrap_surface
from sim_export.package import Inertial, Mesh, SimPackage
from sim_export.physics.links import PartGeometry, build_links, link_names, link_surfaces
from sim_export.source_faults import Shown, show_links


@dataclass(frozen=True, kw_only=True, eq=False)
class Source:
    """An object before conversion.

    ``surfaces`` are the triangles of every part (m, object frame at rest), ``shifts`` the translation of each
    part (m), ``posts`` the triangles (m) that were added and the part of each, ``records`` the repairs, one
    sentence each, and ``before`` the object before the last of them.
    """

    asset: Asset
    surfaces: tuple[Float[np.ndarray, "F 3 3"], ...]
    shifts: Float[np.ndarray, "P 3"]
    posts: tuple[tuple[int, Float[np.ndarray, "F 3 3"]], ...] = ()
    records: tuple[str, ...] = ()
    before: "Source | None" = None

    @cached_property
    def links(self) -> dict[str, Float[np.ndarray, "F 3 3"]]:
        """Triangles of every link that has triangles."""
        return link_surfaces(self.asset, self.surfaces)

    @cached_property
    def subject(self) -> Subject:
        """The object as checks of openings and handles read it."""
        return read_draft(source_package(self))

    @cached_property
    def shown(self) -> dict[str, Shown]:
        """The surfaces of all links for measuring overlaps; those of ``before`` where they are the same."""
        known = self.before and (self.before.links, self.before.shown)
        return show_links(self.links, known)


def open_source(asset: Asset, surfaces: tuple[Float[np.ndarray, "F 3 3"], ...]) -> Source:
    """An object without repairs."""
    return Source(asset=asset, surfaces=tuple(surfaces), shifts=np.zeros((len(surfaces), 3)))


def source_package(source: Source) -> SimPackage:
    """The object as a package for checks: its own surface, and one convex hull per part."""
    geometry = [
        PartGeometry(
            visuals=(as_mesh(triangles),) if len(triangles) else (),
            hulls=wrap_surface(triangles),
            inertial=Inertial(mass=1.0, com=source.asset.scale * part.box[0], inertia=0.01 * np.eye(3)),
        )
        for part, triangles in zip(source.asset.parts, source.surfaces, strict=True)
    ]
    tree = build_links(source.asset, geometry)
    return SimPackage(
        name=source.asset.name,
        category=source.asset.category,
        visual="source",
        links=tree.links,
        joints=tree.joints,
    )


def as_mesh(triangles: Float[np.ndarray, "F 3 3"]) -> Mesh:
    """Triangles as a mesh without shared vertices."""
    return Mesh(vertices=triangles.reshape(-1, 3), faces=np.arange(3 * len(triangles)).reshape(-1, 3))


def leading_part(source: Source, link: str) -> int:
    """Index of the part that leads a link."""
    return next(part for part, name in link_names(source.asset).items() if name == link)


def set_joint(source: Source, part: int, record: str, **changes: object) -> Source:
    """The object with one joint changed; its fields are in unit-cube lengths."""
    parts = list(source.asset.parts)
    parts[part] = replace(parts[part], joint=replace(parts[part].joint, **changes))  # pyright: ignore[reportArgumentType]
    changed = replace(source.asset, parts=tuple(parts))
    return replace(source, asset=changed, records=(*source.records, record), before=source)


def move_part(source: Source, part: int, shift: Float[np.ndarray, "3"], record: str) -> Source:
    """The object with a part and its descendants moved by ``shift`` (m), including joints."""
    asset, step = source.asset, np.asarray(shift) / source.asset.scale
    moved = np.zeros(len(asset.parts), dtype=bool)
    for index in range(len(asset.parts)):
        at = index
        while at not in (-1, part):
            at = asset.parts[at].parent
        moved[index] = at == part
    parts = tuple(
        replace(
            old,
            box=np.stack([old.box[0] + step, old.box[1]]),
            joint=replace(old.joint, origin=old.joint.origin + step),
        )
        if moved[index]
        else old
        for index, old in enumerate(asset.parts)
    )
    surface = asset.surface
    if surface is not None:
        points = surface.points + np.where(moved[surface.part_ids][:, None], step, 0.0)
        surface = replace(surface, points=points)
    return replace(
        source,
        asset=replace(asset, parts=parts, surface=surface),
        surfaces=tuple(
            s + shift if moved[index] else s for index, s in enumerate(source.surfaces)
        ),
        shifts=source.shifts + np.where(moved[:, None], shift, 0.0),
        records=(*source.records, record),
        before=source,
    )  # fmt: skip
