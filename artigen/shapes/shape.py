"""`Shape`: a procedural articulated object as a value, in metres.

Frame: z up, front -x, the floor at z = 0. Joint coordinates follow CONVENTIONS.md: 0 is closed, positive
opens; here, prismatic joints are in metres.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass

import numpy as np
from jaxtyping import Float

from artigen.brief import Brief
from artigen.shapes.primitives import Primitive, place_vertices
from artigen.shapes.surfaces.finishes import Finish
from artigen.types import ENDLESS, PART_LABELS, Joint, PartLabel, check_tree


@dataclass(frozen=True, kw_only=True, eq=False)
class Need:
    """Another part that must be open before this one moves, and the required share of its range."""

    part: str
    fraction: float = 0.95


@dataclass(frozen=True, eq=False, repr=False)
class ShapePart(Brief):
    """A rigid part with a label, as a union of convex primitives.

    ``joint`` is that to its parent, in metres and radians, in the object frame at rest, closed at 0;
    None is a fixed one.
    """

    name: str
    label: PartLabel
    primitives: Sequence[Primitive]
    joint: Joint | None = None
    _: KW_ONLY
    parent: str | None = "body"
    """Name of the part that carries it; None for the base."""
    needs: tuple[Need, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "primitives", tuple(self.primitives))
        if self.label not in PART_LABELS:
            raise ValueError(
                f"part {self.name!r}: label {self.label!r} is not one of {', '.join(PART_LABELS)}"
            )
        if not self.primitives:
            raise ValueError(f"part {self.name!r} has no primitives")
        joint = self.joint
        if joint is not None and (joint.type == "fixed" or joint.lower != 0.0 or not joint.upper > 0.0):
            raise ValueError(
                f"part {self.name!r}: a {joint.type} joint from {joint.lower:g} to {joint.upper:g}, expected "
                "one that moves, from 0 up"
            )
        if joint is not None and (joint.spring < 0.0 or (joint.type in ENDLESS and joint.spring != 0.0)):
            raise ValueError(
                f"part {self.name!r}: a spring of {joint.spring:g} at a {joint.type} joint, expected 0 or "
                "more, and 0 at one without limits"
            )
        if joint is not None and joint.type == "screw" and joint.pitch == 0.0:
            raise ValueError(f"part {self.name!r}: a screw joint without a pitch, which is that of a hinge")

    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Lowest and highest corner at rest (m)."""
        points = np.concatenate([place_vertices(primitive) for primitive in self.primitives])
        return np.stack([points.min(axis=0), points.max(axis=0)])


def make_base(primitives: Sequence[Primitive], name: str = "body") -> ShapePart:
    """The base of an object, which carries its other parts."""
    return ShapePart(name, "base", primitives, parent=None)


def require(*parts: str, fraction: float = 0.95) -> tuple[Need, ...]:
    """Parts that must all be open before another one moves, and the required share of their range."""
    return tuple(Need(part=part, fraction=fraction) for part in parts)


@dataclass(frozen=True, kw_only=True)
class Condition:
    """The condition that a user would state to get this object."""

    category: str
    counts: tuple[tuple[PartLabel, int], ...]
    width: float
    depth: float
    height: float
    style: str


def _check_followers(name: str, parts: tuple[ShapePart, ...]) -> None:
    """Raises `ValueError` unless every leader has limits and follows nothing itself."""
    motions = {part.name: part.joint for part in parts}
    for part in parts:
        if part.joint is None or part.joint.follows is None:
            continue
        leader = motions[part.joint.follows]
        if leader is None or {leader.type, part.joint.type} & set(ENDLESS) or leader.follows is not None:
            raise ValueError(
                f"{name}: part {part.name!r} follows {part.joint.follows!r}; both must have two limits, and "
                f"the second must follow nothing itself"
            )
        if any(need.part == part.name for other in parts for need in other.needs):
            raise ValueError(
                f"{name}: a part needs {part.name!r}, which follows {part.joint.follows!r}, to be open; "
                f"let it need {part.joint.follows!r}"
            )
        if part.joint.offset != 0.0 or not np.isclose(part.joint.ratio * leader.upper, part.joint.upper):
            raise ValueError(
                f"{name}: part {part.name!r} follows {part.joint.follows!r} times "
                f"{part.joint.ratio:g} plus {part.joint.offset:g}, expected "
                f"{part.joint.upper / leader.upper:g} and 0: both close and open at the same time"
            )


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Shape(Brief):
    """An exact articulated object: parts made of convex primitives, joints and finishes, in metres."""

    category: str
    seed: int
    style: str
    parts: tuple[ShapePart, ...]
    finishes: tuple[tuple[str, Finish], ...]

    def __post_init__(self) -> None:
        names = [part.name for part in self.parts]
        unknown = {part.parent for part in self.parts} - {None, *names}
        unknown |= {need.part for part in self.parts for need in part.needs} - set(names)
        unknown |= {part.joint.follows for part in self.parts if part.joint is not None} - {None, *names}
        if unknown:
            raise ValueError(f"{self.name}: parts {sorted(map(str, unknown))} are referenced but missing")
        parents = [-1 if part.parent is None else names.index(part.parent) for part in self.parts]
        check_tree(self.name, names, parents)
        _check_followers(self.name, self.parts)
        finishes = {name for name, _ in self.finishes}
        used = {p.finish for part in self.parts for p in part.primitives}
        used |= {p.lining for part in self.parts for p in part.primitives if p.lining is not None}
        if used - finishes:
            raise ValueError(f"{self.name}: finishes {sorted(used - finishes)} are used but not defined")

    @property
    def name(self) -> str:
        """Category and seed."""
        return f"{self.category}_{self.seed}"

    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Lowest and highest corner of the closed object (m)."""
        corners = np.stack([part.bounds() for part in self.parts])
        return np.stack([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])

    @property
    def condition(self) -> Condition:
        """The condition that this object meets."""
        depth, width, height = (float(v) for v in np.diff(self.bounds(), axis=0)[0])
        held = Counter(part.label for part in self.parts)
        counts: tuple[tuple[PartLabel, int], ...] = tuple(
            (label, held[label]) for label in PART_LABELS if held[label]
        )
        return Condition(
            category=self.category, counts=counts, width=width, depth=depth, height=height, style=self.style
        )
