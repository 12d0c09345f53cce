"""L0, the numbers: mass, inertia and size (V007 to V009)."""

import numpy as np

from artigen.files.urdf import UrdfInertial, UrdfLink
from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, always, count_problems
from sim_export.checks.subject import Subject
from sim_export.collision.contacts import HullSet


def _solid_links(subject: Subject) -> list[UrdfLink]:
    """Links with geometry; an empty root needs no mass."""
    return [link for link in subject.links.values() if link.visuals or link.collisions]


def check_mass(subject: Subject, cfg: CheckConfig) -> Finding:
    """V007: every link with geometry has a plausible mass."""
    masses = {
        link.name: 0.0 if link.inertial is None else link.inertial.mass for link in _solid_links(subject)
    }
    if not masses:
        return count_problems([("", "no link has any geometry")], "")
    low, high = cfg.min_mass, cfg.max_mass
    distance = {
        name: np.inf if not (np.isfinite(mass) and mass > 0) else max(low / mass, mass / high)
        for name, mass in masses.items()
    }
    where = max(distance, key=lambda name: distance[name])
    mass = masses[where]
    message = f"link masses span {min(masses.values()):.4g} to {max(masses.values()):.4g} kg"
    if subject.links[where].inertial is None:
        message = f"link {where!r} states no mass"
    elif distance[where] > 1.0:
        message = f"link {where!r} weighs {mass:.4g} kg, allowed is {low:g} to {high:g} kg"
    return Finding(
        passed=bool(distance[where] <= 1.0),
        value=float(mass) if np.isfinite(mass) else None,
        threshold=high if mass > high else low,
        unit="kg",
        where=where,
        message=message,
    )


def check_inertia(subject: Subject, cfg: CheckConfig) -> Finding:
    """V008: inertia is positive definite, obeys the triangle inequality, and the COM lies in the link."""
    problems = []
    for link in _solid_links(subject):
        if link.inertial is None:
            problems.append((link.name, f"link {link.name!r} states no inertia"))
            continue
        faults = _inertia_faults(link.inertial, cfg)
        T = subject.poses[link.name]
        com = T[:3, :3] @ link.inertial.com + T[:3, 3]
        outside = distance_outside(subject, link.name, com)
        if not outside <= cfg.com_tolerance:
            faults.append(f"has its centre of mass {1e3 * outside:.3g} mm outside its convex hull")
        problems += [(link.name, f"link {link.name!r} {fault}") for fault in faults]
    return count_problems(problems, f"inertia of {len(_solid_links(subject))} links is physical")


def _inertia_faults(inertial: UrdfInertial, cfg: CheckConfig) -> list[str]:
    if not (np.isfinite(inertial.inertia).all() and np.isfinite(inertial.com).all()):
        return ["has an inertia or centre of mass that is not finite"]
    small, middle, large = np.linalg.eigvalsh(inertial.inertia)
    if small <= 0.0:
        return [f"has a principal moment of {small:.3g} kg m2, expected above 0"]
    if large > (small + middle) * (1.0 + cfg.inertia_tolerance):
        return [
            f"has principal moments {small:.4g}, {middle:.4g}, {large:.4g} kg m2, "
            "of which the largest exceeds the sum of the others"
        ]
    return []


def distance_outside(subject: Subject, link: str, point: np.ndarray) -> float:
    """Lower bound on the distance of a point outside the convex hull of a link's vertices (m)."""
    from scipy.spatial import ConvexHull, QhullError

    corners = _extreme(subject, link)
    if len(corners) <= corners.shape[1]:
        return np.inf
    try:
        planes = ConvexHull(corners - point).equations
    except QhullError:
        return np.inf
    return max(0.0, float(planes[:, 3].max()))


def _extreme(subject: Subject, link: str) -> np.ndarray:
    hulls: HullSet = subject.hull_sets[link]
    return hulls.vertices if len(hulls.vertices) else subject.points(link)


def check_size(subject: Subject, cfg: CheckConfig) -> Finding:
    """V009: the object's size is typical of its category, which verifies that lengths are metres."""
    category = str(subject.meta.get("model_cat", ""))
    ranges = {name: (low, high) for name, low, high in cfg.category_diagonals}
    low, high = ranges.get(category, cfg.diagonal_range)
    diagonal = subject.diagonal
    return Finding(
        passed=low <= diagonal <= high,
        value=diagonal,
        threshold=high if diagonal > high else low,
        unit="m",
        where=category,
        message=f"a diagonal of {diagonal:.4g} m, "
        f"expected {low:g} to {high:g} m for {category or 'any object'}",
    )


PHYSICAL_CHECKS = (
    CheckSpec(id="V007", level="L0", title="mass", applies=always, function=check_mass),
    CheckSpec(id="V008", level="L0", title="inertia", applies=always, function=check_inertia),
    CheckSpec(id="V009", level="L0", title="size in metres", applies=always, function=check_size),
)
