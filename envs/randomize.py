"""Draws other friction, damping, masses and looks for an object, within ranges around its own."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sim_export.package import SimPackage

if TYPE_CHECKING:
    from sapien.physx import PhysxArticulationLinkComponent

SAME = (1.0, 1.0)
SEEDS = 2**31


@dataclass(frozen=True, kw_only=True)
class Randomization:
    """Ranges of factors on what a package states; each value is drawn uniformly and by itself.

    A range of (1, 1) leaves values as they are.
    """

    friction: tuple[float, float] = SAME
    """On the friction of each joint."""
    damping: tuple[float, float] = SAME
    """On the damping of each joint."""
    mass: tuple[float, float] = SAME
    """On mass and inertia of each link."""
    looks: bool = False
    """Finishes of another object of the kind; needs a scene that renders."""
    style: str | None = None
    """A style of the kind for the looks, such as navy or steel; any if None."""

    def __post_init__(self) -> None:
        for name in ("friction", "damping", "mass"):
            low, high = getattr(self, name)
            if not 0.0 <= low <= high or (name == "mass" and low == 0.0):
                raise ValueError(f"{name} {low} to {high}: expected factors from low to high, not below 0")


def read_randomization(value: "Randomization | Mapping[str, Any] | None") -> Randomization:
    """A randomization, also from a mapping such as ``{"friction": (0.5, 2.0)}``; None changes nothing.

    Raises:
        ValueError: If a name is unknown or a range is empty.
    """
    if isinstance(value, Randomization):
        return value
    known = [field.name for field in fields(Randomization)]
    if unknown := sorted(set(value or {}) - set(known)):
        raise ValueError(f"randomize has {', '.join(unknown)}, expected {', '.join(known)}")
    return Randomization(**(value or {}))


def randomize_package(
    package: SimPackage, cfg: Randomization, rng: np.random.RandomState | np.random.Generator
) -> SimPackage:
    """The package with other joint friction and damping and other masses; itself, and nothing is drawn, where
    all ranges are (1, 1)."""
    if (cfg.friction, cfg.damping, cfg.mass) == (SAME, SAME, SAME):
        return package

    def draw(limits: tuple[float, float]) -> float:
        return 1.0 if limits == SAME else float(rng.uniform(*limits))

    joints = tuple(
        replace(
            joint, friction=joint.friction * draw(cfg.friction), damping=joint.damping * draw(cfg.damping)
        )
        for joint in package.joints
    )
    links = []
    for link in package.links:
        factor, own = draw(cfg.mass), link.inertial
        if own is not None:
            own = replace(own, mass=own.mass * factor, inertia=own.inertia * factor)
        links.append(replace(link, inertial=own))
    return replace(package, joints=joints, links=tuple(links))


def set_masses(
    links: "Iterable[PhysxArticulationLinkComponent]", package: SimPackage, prefix: str = ""
) -> None:
    """Gives links in the engine the masses of a package, and their inertia in proportion.

    Args:
        prefix: What the engine's names have before those of the package.
    """
    masses = {prefix + link.name: link.inertial.mass for link in package.links if link.inertial is not None}
    for link in links:
        if link.name in masses:
            link.set_inertia((np.asarray(link.inertia) * (masses[link.name] / link.mass)).tolist())
            link.set_mass(masses[link.name])
