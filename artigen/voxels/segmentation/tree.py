"""Kinematic tree: each part gets a parent that it touches and that its label allows.

The paper is silent on the tree. The rule here is explicit: `ALLOWED_PARENTS` says which labels a
part may hang from and how strongly it prefers them; of the parts that it touches, the one with the
largest preference-weighted contact is the parent. What reaches far beyond a door does not hang from that:
a shelf behind it rests in the body, a handle across its edge sits on the drawer below. A part that touches
none of these hangs from what it touches, whatever that is: a lid from a lever, a lever from another one.
There is one base; whatever touches nothing within reach is reported, never guessed.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Int
from scipy.spatial import KDTree

from artigen.types import Part, PartLabel

ALLOWED_PARENTS: Mapping[PartLabel, Mapping[PartLabel, float]] = {
    "drawer": {"base": 1.0},
    "door": {"base": 1.0},
    "handle": {"drawer": 3.0, "door": 3.0, "tray": 3.0, "knob": 1.0, "base": 1.0},
    "knob": {"door": 1.5, "drawer": 1.5, "base": 1.0},
    "tray": {"base": 1.0, "drawer": 0.3},
    "shelf": {"base": 1.0, "door": 1.0},
    "wheel": {"wheel": 3.0, "knob": 3.0, "base": 1.0},
}
"""For each label, the labels it may hang from, with the factor on their contact count.

Equal labels: a wheel hangs from a wheel only where that one is a caster's stem, see `_is_stem`.
"""
PANELS: frozenset[PartLabel] = frozenset({"door", "drawer", "tray"})
"""Parts that others may touch without hanging from them, because these lie behind or beside them."""
ON_SURFACES: frozenset[PartLabel] = frozenset({"handle", "knob"})
"""Parts that sit on a panel, where they touch one, rather than on the base."""

REACH = 2.0
"""Voxels between the nearest cells of a part and its parent; 1 means touching. Raise it when
parts that hover over their parent are reported as detached."""


def contact_counts(
    part_ids: Int[np.ndarray, "N"], pairs: Int[np.ndarray, "2 E"], count: int
) -> Int[np.ndarray, "P P"]:
    """Number of neighbouring voxel pairs between every two parts."""
    a, b = part_ids[pairs[0]], part_ids[pairs[1]]
    contact = np.bincount(a.astype(np.int64) * count + b, minlength=count * count).reshape(count, count)
    return contact + contact.T


def find_parents(
    parts: Sequence[Part],
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    pairs: Int[np.ndarray, "2 E"],
) -> list[int | None]:
    """Parent of every part: -1 for the base, None where no part at all is within reach.

    Parts that touch compete by contact, panels that the part's middle does not lie on or in after all others;
    only where none touches does the nearest within reach win. What has no allowed parent within reach hangs
    from any part that hangs from the base itself, in the order of contact.
    """
    contact = contact_counts(part_ids, pairs, len(parts))
    parents: list[int | None] = []
    for index, part in enumerate(parts):
        if part.label == "base":
            parents.append(-1)
            continue
        weights = np.array([ALLOWED_PARENTS[part.label].get(other.label, 0.0) for other in parts])
        for k, other in enumerate(parts):
            if other.label == part.label and (_is_stem(part) or not _is_stem(other)):
                weights[k] = 0.0
        scores = contact[index] * weights
        off = np.array([other.label in PANELS and not _holds(other, part) for other in parts])
        sits = [part.label not in ON_SURFACES or other.label != "base" for other in parts]
        if scores[sits & ~off].max(initial=0.0) > 0:
            scores[off] = 0.0
        if scores.max(initial=0.0) > 0:
            parents.append(int(scores.argmax()))
        else:
            parents.append(_nearest_parent(index, np.flatnonzero(weights), coords, part_ids))
    return _hang_rest(parents, contact, coords, part_ids)


def _hang_rest(
    parents: list[int | None], contact: np.ndarray, coords: np.ndarray, part_ids: np.ndarray
) -> list[int | None]:
    """Hangs parts without a parent from parts of any label that hang from the base.

    Of these the pair of the most contact comes first, then the nearest within reach. Where only a part that
    hangs from a lost one meets the others (a lever with a lid), that part is hung anew and carries the other.
    """
    out = list(parents)

    def is_held(index: int) -> bool:
        at: int | None = index
        while at is not None and at != -1:
            at = out[at]
        return at == -1

    while None in out:
        held = [index for index in range(len(out)) if is_held(index)]
        lost = [index for index, parent in enumerate(out) if parent is None]
        carried = [index for index in range(len(out)) if index not in held and index not in lost]
        found = next(
            filter(None, (_meet(some, held, contact, coords, part_ids) for some in (lost, carried))),
            None,
        )
        if found is None:
            break
        out[found[0]] = found[1]
    return out


def _meet(
    some: list[int], held: list[int], contact: np.ndarray, coords: np.ndarray, part_ids: np.ndarray
) -> tuple[int, int] | None:
    """The part among ``some`` that meets one of ``held`` most, and that one; None where none is in reach."""
    touches = contact[some][:, held]
    if touches.max(initial=0) > 0:
        row, column = divmod(int(touches.argmax()), len(held))
        return some[row], held[column]
    near = ((index, _nearest_parent(index, np.array(held), coords, part_ids)) for index in some)
    return next(((index, parent) for index, parent in near if parent is not None), None)


def _holds(panel: Part, part: Part) -> bool:
    """Whether the middle of a part's box lies in a panel's box or, for handles and knobs, in front of it."""
    within = int((np.abs(part.box[0] - panel.box[0]) <= panel.box[1] / 2).sum())
    return within >= (2 if part.label in ON_SURFACES else 3)


def _is_stem(part: Part) -> bool:
    """Whether a part swivels about the vertical, as the stem of a caster does (and no rolling wheel)."""
    return part.joint.type in ("continuous", "revolute") and abs(part.joint.axis[2]) > 0.9


def _nearest_parent(index: int, allowed: np.ndarray, coords, part_ids) -> int | None:
    own = KDTree(coords[part_ids == index])
    best, nearest = None, REACH + 1e-9
    for candidate in allowed:
        distance = own.query(coords[part_ids == candidate])[0].min(initial=np.inf)
        if distance < nearest:
            best, nearest = int(candidate), distance
    return best
