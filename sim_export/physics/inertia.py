"""Exact mass, centre of mass and inertia of closed meshes, and checks that they are physical.

Polyhedral integrals by the divergence theorem: every face spans a signed tetrahedron with a point near the
mesh, and the integrals of 1, x and x x^T over tetrahedra have closed forms.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float, Int

from artigen.types import Joint
from sim_export.errors import DegeneratePart, InvalidInertia, OpenMesh
from sim_export.motion.kinematics import hanging_links
from sim_export.package import Hull, Inertial, Link, Mesh

MIN_LINK_MASS = 0.01
"""Least mass (kg) of a link; in objects up to `SMALL` ..."""
SMALL, LIGHT_SHARE, LIGHTEST = 0.25, 0.04, 0.001
"""... (m) this share of their mass where that is less, but at least so much (kg): ten buttons of 10 g on a
remote control of 20 g would make it dance."""
TRIANGLE_TOLERANCE = 1e-6


def is_closed(faces: Int[np.ndarray, "F 3"]) -> bool:
    """Whether every directed edge occurs as often as its opposite, so that the faces bound a volume."""
    if not len(faces):
        return False
    start, end = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel().astype(np.int64)
    low, high = np.minimum(start, end), np.maximum(start, end)
    _, edge = np.unique(low * (int(high.max()) + 1) + high, return_inverse=True)
    return not np.bincount(edge.ravel(), np.sign(end - start)).any()


def mesh_inertial(mesh: Mesh | Hull, density: float) -> Inertial:
    """Mass properties of the volume inside a closed mesh at a uniform ``density`` (kg/m^3).

    Raises:
        OpenMesh: If the faces are not closed, or are oriented inwards.
        DegeneratePart: If they enclose no volume.
        InvalidInertia: If ``density`` is not positive.
    """
    if not (np.isfinite(density) and density > 0):
        raise InvalidInertia(f"density {density} kg/m^3, expected > 0")
    if not len(mesh.faces):
        raise DegeneratePart("a mesh without faces has no mass")
    if not is_closed(mesh.faces):
        raise OpenMesh(f"the mesh of {len(mesh.faces)} faces is not closed, so it has no volume to weigh")
    center = mesh.vertices.mean(axis=0)
    corners = (mesh.vertices - center)[mesh.faces]  # F 3 3
    sixths = np.einsum("fi,fi->f", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    volume = sixths.sum() / 6.0
    size = float(np.prod(np.ptp(mesh.vertices, axis=0)))
    if abs(volume) <= 1e-9 * size or size == 0.0:
        raise DegeneratePart(f"the mesh encloses {volume:.3g} m^3, its box {size:.3g} m^3")
    if volume < 0:
        raise OpenMesh(f"the mesh is inside out: it encloses {volume:.3g} m^3")
    total = corners.sum(axis=1)  # F 3
    com = np.einsum("f,fi->i", sixths, total) / 24.0 / volume
    # Integral of x x^T over a tetrahedron (0, a, b, c): det/120 (a a^T + b b^T + c c^T + s s^T), s = a+b+c.
    second = np.einsum("f,fki,fkj->ij", sixths, corners, corners)
    second = (second + np.einsum("f,fi,fj->ij", sixths, total, total)) / 120.0
    second -= volume * np.outer(com, com)
    inertia = density * (np.trace(second) * np.eye(3) - second)
    return Inertial(mass=float(density * volume), com=center + com, inertia=(inertia + inertia.T) / 2)


def inertia_about(inertial: Inertial, point: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """Inertia about another point (parallel axis theorem)."""
    arm = np.asarray(inertial.com) - point
    return inertial.inertia + inertial.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))


def combine(inertials: Sequence[Inertial]) -> Inertial:
    """Mass properties of several bodies welded together; raises `ValueError` for an empty sequence."""
    if not inertials:
        raise ValueError("nothing to combine: no inertials given")
    mass = sum(inertial.mass for inertial in inertials)
    weighted = [inertial.mass * np.asarray(inertial.com) for inertial in inertials]
    com = np.sum(weighted, axis=0) / mass
    inertia = np.sum([inertia_about(inertial, com) for inertial in inertials], axis=0)
    return Inertial(mass=float(mass), com=com, inertia=inertia)


def check_inertial(inertial: Inertial, owner: str) -> None:
    """Raises `InvalidInertia` unless mass and inertia are physical.

    The mass must be positive; the inertia finite, symmetric and positive definite; the largest principal
    moment at most the sum of the others (relative tolerance 1e-6).
    """
    values = np.concatenate([[inertial.mass], inertial.com, np.ravel(inertial.inertia)])
    if not np.isfinite(values).all():
        raise InvalidInertia(f"{owner}: mass, centre or inertia holds NaN or infinite values")
    if not inertial.mass > 0:
        raise InvalidInertia(f"{owner}: mass {inertial.mass:.6g} kg, expected > 0")
    inertia = np.asarray(inertial.inertia)
    if np.abs(inertia - inertia.T).max() > TRIANGLE_TOLERANCE * np.abs(inertia).max():
        raise InvalidInertia(f"{owner}: inertia {inertia.tolist()} is not symmetric")
    small, middle, large = np.linalg.eigvalsh(inertia)
    if not small > 0:
        raise InvalidInertia(
            f"{owner}: principal moments {small:.6g}, {middle:.6g}, {large:.6g}: expected > 0"
        )
    if large > (small + middle) * (1.0 + TRIANGLE_TOLERANCE):
        raise InvalidInertia(
            f"{owner}: principal moments {small:.9g} + {middle:.9g} < {large:.9g} kg m^2: no mass "
            f"distribution has this inertia (triangle inequality)"
        )


def least_mass(whole: float, size: float) -> float:
    """Least mass (kg) of the links of an object of ``whole`` kg, whose longest edge is ``size`` (m)."""
    return float(np.clip(LIGHT_SHARE * whole, LIGHTEST, MIN_LINK_MASS)) if size <= SMALL else MIN_LINK_MASS


def raise_light_mass(
    inertial: Inertial, owner: str, least: float = MIN_LINK_MASS
) -> tuple[Inertial, str | None]:
    """Scales mass and inertia up to at least ``least`` (kg); the second value records a change.

    Physics engines lose precision with lighter links. The shape of the inertia is preserved.
    """
    if inertial.mass >= least:
        return inertial, None
    heavier = replace(inertial, mass=least, inertia=inertial.inertia * (least / inertial.mass))
    return heavier, f"{owner}: mass raised from {inertial.mass:.3g} to {least:.3g} kg"


def subtree_inertial(links: Sequence[Link], joints: Sequence[Joint], name: str) -> Inertial:
    """Mass properties, at rest, of a link and all its descendants."""
    inside = hanging_links(joints, name)
    return combine([link.inertial for link in links if link.name in inside and link.inertial is not None])
