"""`Fault`: a defect of a shape that would make the exported package fail a check.

Each id corresponds to one measurement of a check:

overlap    V202  two rigid bodies overlap at rest; a little of it fails V308 alone
blocked    V201  a body collides with another one along its joint's range
unheld     V305  a part requires its latch opened, which does not hold it closed
floating   V104  a gap separates a body, or a fixed part, from its carrier
loose            pieces of a part are detached from the rest; visible, but no check measures it
inward     V203  a drawer or door opens into the body, or away from its handle
hinge      V203  a door rotates about a line that is not its edge
unhung           the line that a door rotates about is away from its carrier; no check measures it
sealed           walls enclose the cavity behind a door on all sides; visible, but no check measures it
handle     V204  a handle cannot be grasped
released   V206  a drawer leaves its carrier when it is open
range      V005  a slide is longer than the object, or a hinge turns more than one revolution
thin       V102  a primitive is too thin to be a hull
crowded    V006  a body has more hulls than engines handle well
tipping    V303  the centre of volume lies outside of the support polygon
unmet            a part requires a static part to be open; exporters refuse it
adrift           the root part has a joint; exporters refuse it
open             a hole is in the front of a kind that has none; visible, but no check measures it
                 (`artigen.sketch.front`)
extent           the object misses the requested size (`artigen.sketch.model`)
"""

from dataclasses import dataclass
from typing import Literal

FaultId = Literal[
    "overlap", "blocked", "unheld", "floating", "loose", "inward", "hinge", "unhung", "sealed",
    "handle", "released", "range", "thin", "crowded", "tipping", "unmet", "adrift", "open", "extent",
]  # fmt: skip

_METRES = {"overlap", "blocked", "floating", "loose", "hinge", "handle", "thin", "tipping", "extent"}


@dataclass(frozen=True, kw_only=True)
class Fault:
    """A defect: its id, the parts involved, the measured value and the limit.

    ``value`` and ``allowed`` are metres; shares for ``unheld``, ``unhung``, ``sealed``, ``inward``, ``open``
    and ``released``; counts for ``crowded``; metres of a slide or radians of a hinge for ``range`` and
    ``adrift``; unused for ``unmet``.
    """

    id: FaultId
    part: str
    other: str | None = None
    value: float
    allowed: float

    @property
    def text(self) -> str:
        """One sentence with the measured value, the parts and the limit."""
        unit, factor = ("mm", 1e3) if self.id in _METRES else ("%", 1e2)
        if self.id in ("range", "adrift", "crowded"):
            unit, factor = "", 1.0
        found, allowed = (f"{factor * number:.3g} {unit}".strip() for number in (self.value, self.allowed))
        return _SENTENCES[self.id].format(part=self.part, other=self.other, value=found, allowed=allowed)


_SENTENCES: dict[FaultId, str] = {
    "overlap": "{part} and {other} overlap by {value} at rest, allowed is {allowed}",
    "blocked": "{part} runs into {other} by {value} along its range, allowed is {allowed}",
    "unheld": "{part} moves by {value} of its range although {other} on it is closed, allowed is {allowed}",
    "floating": "{part} is {value} away from {other}, allowed is {allowed}",
    "loose": "pieces of {part} are {value} away from the rest, allowed is {allowed}",
    "inward": "{part} opens into {other} or away from its handle: {value} more sight lines are blocked ahead "
    "than behind, allowed is {allowed}",
    "hinge": "{part} rotates about a line {value} from its edge, allowed is {allowed}",
    "unhung": "{part} hangs on {other} along {value} of its hinge, at least {allowed} is needed",
    "sealed": "{part} opens onto a cavity that {other} encloses, over {value} of its area, "
    "allowed is {allowed}",
    "handle": "{part} cannot be grasped: {value} of clearance is missing, allowed is {allowed}",
    "released": "{part} keeps {value} of its depth in its carrier when open, at least {allowed} is needed",
    "range": "{part} moves by {value} (m or rad), allowed is {allowed}",
    "thin": "{part} has a piece {value} thin, at least {allowed} is needed",
    "crowded": "the body of {part} has {value} hulls or links, allowed is {allowed}",
    "tipping": "the centre of volume lies {value} outside of the support polygon at {part}, "
    "allowed is {allowed}",
    "unmet": "{part} requires {other} to be open, which does not move",
    "open": "{value} of the front of {part} is open although all is closed, allowed is {allowed}",
    "extent": "the {part} differs by {value} from the request, allowed is {allowed}",
    "adrift": "{part} carries all others and moves by {value} (m or rad), it must be fixed",
}
