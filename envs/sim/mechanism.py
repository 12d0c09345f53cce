"""Followers and springs of a package: which columns of a joint vector they are, and where they belong.

Values only: `envs.sim.articulation` moves them in SAPIEN. MuJoCo has both in the MJCF.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from artigen.types import Joint
from sim_export.errors import PackageError
from sim_export.package import SimPackage


@dataclass(frozen=True, kw_only=True)
class Follower:
    """A joint at ``multiplier`` times its leader's coordinate, plus ``offset`` (m or rad): a screw's travel
    and its turn, a lid and its pedal. ``column`` and ``leader`` index the joint vector."""

    column: int
    leader: int
    multiplier: float
    offset: float

    def follow(self, q: float) -> float:
        """Coordinate (m or rad) where the leader's is ``q``."""
        return self.multiplier * q + self.offset


@dataclass(frozen=True, kw_only=True, eq=False)
class Spring:
    """A joint with a spring, and its column of the joint vector."""

    column: int
    spec: Joint


@dataclass(frozen=True, kw_only=True, eq=False)
class Mechanism:
    """Everything that moves or pulls by itself in one object; empty for most."""

    followers: tuple[Follower, ...] = ()
    springs: tuple[Spring, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.followers or self.springs)

    def complete(self, qpos: Any) -> Any:
        """A copy of joint vectors ``[*B, Q]`` (m or rad), an array or a tensor, with all followers where
        their leaders put them."""
        out = qpos.copy() if isinstance(qpos, np.ndarray) else qpos.clone()
        for each in self.followers:
            out[..., each.column] = each.multiplier * out[..., each.leader] + each.offset
        return out


def find_mechanism(package: SimPackage, names: Sequence[str], held: Collection[str] = ()) -> Mechanism:
    """The mechanism of a package in an engine.

    Args:
        names: Its moving joints in the order of the joint vector.
        held: Joints without their springs, because something keeps them where they are.

    Raises:
        PackageError: If a joint follows one that does not move, or itself.
    """
    columns = {name: column for column, name in enumerate(names)}
    specs = {joint.name: joint for joint in package.joints}
    moving = [specs[name] for name in names]
    return Mechanism(
        followers=tuple(_trace(spec, specs, columns) for spec in moving if spec.follows is not None),
        springs=tuple(
            Spring(column=columns[spec.name], spec=spec)
            for spec in moving
            if spec.follows is None and spec.spring != 0.0 and spec.name not in held
        ),
    )


def _trace(spec: Joint, specs: dict[str, Joint], columns: dict[str, int]) -> Follower:
    """A follower and the joint that leads it, over any number of followers between them."""
    multiplier, offset, at, seen = 1.0, 0.0, spec, {spec.name}
    while at.follows is not None:
        offset += multiplier * at.offset
        multiplier *= at.ratio
        if at.follows in seen or at.follows not in columns:
            why = "which follows it" if at.follows in seen else "which does not move"
            raise PackageError(
                f"joint {spec.name!r} follows {at.follows!r}, {why}; let it follow one that moves by itself"
            )
        seen.add(at.follows)
        at = specs[at.follows]
    return Follower(column=columns[spec.name], leader=columns[at.name], multiplier=multiplier, offset=offset)
