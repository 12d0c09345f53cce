"""Duplicates: objects of equal geometry, and objects that differ by less than a share of their surface.

A descriptor is the share of an object's surface in each cell of a grid over its box (16-bit shares,
`sim_export.fingerprint`). Two objects of one category with joints of the same kinds are near duplicates if
their boxes agree within `EXTENTS` and half the sum of absolute differences of their descriptors, the share
of surface in different places, is at most the threshold.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

EXTENTS = 0.01
"""Largest relative difference of the edges of two boxes at which objects may be near duplicates."""
LEVELS = np.iinfo(np.uint16).max
"""Steps of a share in a descriptor."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fingerprint:
    """Fingerprint of an object, for finding duplicates."""

    id: str
    category: str
    joints: tuple[str, ...]
    """Kinds of the joints, in order."""
    extents: tuple[float, float, float]
    geometry: str
    """Hash of the exact geometry."""
    descriptor: bytes
    """Shares as little-endian 16-bit numbers."""


@dataclass(frozen=True, kw_only=True)
class Duplicate:
    """An object that is left out, and why."""

    id: str
    of: str
    """The object that stays."""
    distance: float
    """Share of the surface that lies elsewhere; 0 for equal geometry."""


class Duplicates:
    """Objects kept so far, searched for duplicates of further ones."""

    def __init__(self, near: float) -> None:
        """``near``: largest distance of near duplicates; 0 finds equal geometry only."""
        self._near = near
        self._exact: dict[str, str] = {}
        self._groups: dict[tuple[str, tuple[str, ...]], _Group] = {}

    def add(self, one: Fingerprint) -> Duplicate | None:
        """Keeps an object and returns None, or returns which kept object it duplicates."""
        other = self._exact.get(one.geometry)
        if other is not None:
            return Duplicate(id=one.id, of=other, distance=0.0)
        group = self._groups.setdefault((one.category, one.joints), _Group())
        nearest = group.nearest(one) if self._near > 0.0 else None
        if nearest is not None and nearest[1] <= self._near:
            return Duplicate(id=one.id, of=nearest[0], distance=nearest[1])
        self._exact[one.geometry] = one.id
        group.add(one)
        return None


class _Group:
    """Objects that may be near each other, in arrays that grow."""

    def __init__(self) -> None:
        self.ids: list[str] = []
        self.extents: Float[np.ndarray, "N 3"] = np.zeros((0, 3))
        self.descriptors = np.zeros((0, 0), np.uint16)

    def add(self, one: Fingerprint) -> None:
        shares = np.frombuffer(one.descriptor, "<u2")
        count = len(self.ids)
        if count == len(self.extents):
            size = max(16, 2 * count)
            extents, descriptors = np.zeros((size, 3)), np.zeros((size, len(shares)), np.uint16)
            if count:
                extents[:count], descriptors[:count] = self.extents[:count], self.descriptors[:count]
            self.extents, self.descriptors = extents, descriptors
        self.extents[count], self.descriptors[count] = one.extents, shares
        self.ids.append(one.id)

    def nearest(self, one: Fingerprint) -> tuple[str, float] | None:
        """The nearest object whose box agrees, and its distance."""
        count = len(self.ids)
        if not count:
            return None
        known, own = self.extents[:count], np.array(one.extents)
        apart = np.abs(known - own) / np.maximum(np.maximum(known, own), 1e-9)
        rows = np.flatnonzero((apart <= EXTENTS).all(axis=1))
        if not len(rows):
            return None
        shares = np.frombuffer(one.descriptor, "<u2").astype(np.int32)
        distances = np.abs(self.descriptors[rows].astype(np.int32) - shares).sum(axis=1)
        best = int(distances.argmin())
        return self.ids[rows[best]], float(distances[best]) / (2 * LEVELS)
