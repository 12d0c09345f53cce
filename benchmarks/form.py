"""Objects of analytic solids, written as URDFs with one OBJ per link."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import manifold3d
import numpy as np
import trimesh

Solid = manifold3d.Manifold
Triple = tuple[float, float, float]
Flaw = Callable[[np.ndarray], np.ndarray]
"""Changes the triangles of a link."""
ROUND = 48
"""Segments of a full turn."""


@dataclass(frozen=True, kw_only=True)
class Moving:
    """A link that a joint connects to its parent: closed solids (m, object frame), which may overlap, a line,
    and a range."""

    solids: Sequence[Solid]
    type: str
    origin: Triple
    axis: Triple
    upper: float
    parent: str = "body"


@dataclass(frozen=True, kw_only=True)
class Form:
    """An object: the solids of its body, and what moves by name. Fronts face -x."""

    body: Sequence[Solid]
    moving: Mapping[str, Moving]


def hinge(
    solids: Sequence[Solid], origin: Triple, axis: Triple, upper: float, parent: str = "body"
) -> Moving:
    """What turns about a line."""
    return Moving(solids=solids, type="revolute", origin=origin, axis=axis, upper=upper, parent=parent)


def slide(solids: Sequence[Solid], axis: Triple, upper: float, parent: str = "body") -> Moving:
    """What moves along a line."""
    return Moving(solids=solids, type="prismatic", origin=(0, 0, 0), axis=axis, upper=upper, parent=parent)


def spin(solids: Sequence[Solid], origin: Triple, axis: Triple, parent: str = "body") -> Moving:
    """What turns without end."""
    return Moving(solids=solids, type="continuous", origin=origin, axis=axis, upper=0.0, parent=parent)


def turned(profile: Sequence[tuple[float, float]]) -> Solid:
    """What a closed outline of (radius, height) sweeps in a turn about z."""
    return manifold3d.CrossSection([np.array(profile)]).revolve(ROUND)


def shell(outer: Sequence[tuple[float, float]], wall: float, floor: float) -> Solid:
    """An open vessel of revolution: an outer profile of (radius, height), from below, and a wall inside."""
    inner = [(radius - wall, max(height, floor)) for radius, height in outer if radius > wall]
    inner = [point for at, point in enumerate(inner) if at == 0 or point != inner[at - 1]]
    return turned([(0.0, outer[0][1]), *outer, *reversed(inner), (0.0, floor)])


def box(low: Triple, high: Triple) -> Solid:
    """An axis-aligned box."""
    return Solid.cube(tuple(np.subtract(high, low))).translate(low)


def ring(radius: float, wire: float, turn: float = 360.0) -> Solid:
    """A wire bent about z."""
    return manifold3d.CrossSection.circle(wire, 16).translate((radius, 0)).revolve(ROUND, turn)


def rod(start: Triple, end: Triple, radius: float, segments: int = 24) -> Solid:
    """A round bar between two points."""
    way = np.subtract(end, start)
    length = float(np.linalg.norm(way))
    polar = float(np.degrees(np.arccos(way[2] / length)))
    azimuth = float(np.degrees(np.arctan2(way[1], way[0])))
    bar = Solid.cylinder(length, radius, radius, segments)
    return bar.rotate((0, polar, 0)).rotate((0, 0, azimuth)).translate(start)


def rounded(size: Triple, radius: float) -> Solid:
    """A board with rounded corners, standing on z = 0, centred in x and y."""
    inner = manifold3d.CrossSection.square((size[0] - 2 * radius, size[1] - 2 * radius), center=True)
    return inner.offset(radius, manifold3d.JoinType.Round, circular_segments=32).extrude(size[2])


def hollow(low: Triple, high: Triple, wall: float, *, open_to: Triple = (0, 0, 0)) -> Solid:
    """A box of sheet, open to the side that a unit vector names."""
    pads = np.array(open_to) * 2 * wall
    inner_low = np.add(low, wall) + np.minimum(pads, 0.0)
    inner_high = np.subtract(high, wall) + np.maximum(pads, 0.0)
    return box(low, high) - box(tuple(inner_low), tuple(inner_high))


def triangles_of(solids: Sequence[Solid]) -> np.ndarray:
    """The surfaces of solids, side by side, in metres."""
    meshes = [solid.to_mesh64() for solid in solids]
    return np.concatenate([mesh.vert_properties[:, :3][mesh.tri_verts] for mesh in meshes])


def write_form(
    form: Form,
    folder: Path,
    name: str,
    flaws: Sequence[Callable[[np.ndarray], np.ndarray]] = (),
    reach: float = 1.0,
) -> Path:
    """The object as a URDF with one OBJ per link; returns the URDF.

    Args:
        flaws: Changes of the triangles of each link that moves and, but for its size, of the body.
        reach: What ranges are multiplied by.
    """
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f'<robot name="{name}">']
    links = {"body": form.body, **{key: one.solids for key, one in form.moving.items()}}
    at = {"body": (0.0, 0.0, 0.0), **{key: one.origin for key, one in form.moving.items()}}
    for key, solids in links.items():
        triangles = triangles_of(solids)
        for flaw in flaws:
            triangles = flaw(triangles)
        faces = np.arange(3 * len(triangles)).reshape(-1, 3)
        mesh = trimesh.Trimesh(triangles.reshape(-1, 3), faces, process=False)
        if not flaws:
            mesh.merge_vertices()
        mesh.export(folder / f"{key}.obj")
        x, y, z = (-value for value in at[key])
        lines.append(
            f'<link name="{key}"><visual><origin xyz="{x:g} {y:g} {z:g}"/>'
            f'<geometry><mesh filename="{key}.obj"/></geometry></visual></link>'
        )
    for key, one in form.moving.items():
        x, y, z = np.subtract(one.origin, at[one.parent])
        limit = f'<limit lower="0" upper="{reach * one.upper:g}" effort="1" velocity="1"/>'
        lines.append(
            f'<joint name="{key}_joint" type="{one.type}"><parent link="{one.parent}"/><child link="{key}"/>'
            f'<origin xyz="{x:g} {y:g} {z:g}"/>'
            f'<axis xyz="{one.axis[0]:g} {one.axis[1]:g} {one.axis[2]:g}"/>'
            f"{limit if one.type != 'continuous' else ''}</joint>"
        )
    path = folder / f"{name}.urdf"
    path.write_text("\n".join([*lines, "</robot>"]) + "\n")
    return path
