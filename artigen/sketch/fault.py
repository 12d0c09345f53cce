"""`Fault`: something about a shape that would make the exported package fail a check.

Each id stands for what one check measures:

overlap    V202  two rigid bodies overlap at rest
blocked    V201  a body runs into another one along its joint's range
grazing    V201  it enters another one just a little, but with much of its volume
floating   V104  a body, or a part fixed to one, is away from what carries it
loose            pieces of a part are away from the rest; no check notices, a person does
inward     V203  a drawer or door opens into the body, or away from its handle
hinge      V203  a door turns about a line that is not its edge
handle     V204  no hand can take hold of a handle
released   V206  a drawer leaves what holds it
range      V005  a slide is longer than the object, a hinge turns more than once round
thin       V102  a primitive is too thin to be a hull
crowded    V006  a body has more hulls than engines handle well
tipping    V303  the middle of the object is not above what it stands on
unmet            a part needs another one open that does not move; exporters refuse it
adrift           the part that carries all others moves; exporters refuse it
extent           the object is not as large as was asked (`artigen.sketch.model`)
"""

from dataclasses import dataclass
from typing import Literal

FaultId = Literal[
    "overlap", "blocked", "grazing", "floating", "loose", "inward", "hinge",
    "handle", "released", "range", "thin", "crowded", "tipping", "unmet", "adrift", "extent",
]  # fmt: skip

_METRES = {"overlap", "blocked", "floating", "loose", "hinge", "handle", "thin", "tipping", "extent"}


@dataclass(frozen=True, kw_only=True)
class Fault:
    """Something that cannot stay: which kind, where, how far off, and what is allowed.

    ``value`` and ``allowed`` are metres; shares for ``grazing``, ``inward`` and ``released``; numbers for
    ``crowded``; for ``range`` and ``adrift`` metres of a slide and radians of a hinge; nothing for ``unmet``.
    """

    id: FaultId
    part: str
    other: str | None = None
    value: float
    allowed: float

    @property
    def text(self) -> str:
        """One sentence: what was found, where, and what is allowed."""
        unit, factor = ("mm", 1e3) if self.id in _METRES else ("%", 1e2)
        if self.id in ("range", "adrift", "crowded"):
            unit, factor = "", 1.0
        found, allowed = (f"{factor * number:.3g} {unit}".strip() for number in (self.value, self.allowed))
        return _SENTENCES[self.id].format(part=self.part, other=self.other, value=found, allowed=allowed)


_SENTENCES: dict[FaultId, str] = {
    "overlap": "{part} and {other} overlap by {value} at rest, allowed is {allowed}",
    "blocked": "{part} runs into {other} by {value} on its way, allowed is {allowed}",
    "grazing": "{part} enters {other} with {value} of its volume on its way, allowed is {allowed}",
    "floating": "{part} is {value} away from {other}, allowed is {allowed}",
    "loose": "pieces of {part} are {value} away from the rest, allowed is {allowed}",
    "inward": "{part} opens into {other} or away from its handle: {value} more is blocked ahead than behind, "
    "allowed is {allowed}",
    "hinge": "{part} turns about a line {value} from its edge, allowed is {allowed}",
    "handle": "{part} cannot be taken hold of: {value} is missing, allowed is {allowed}",
    "released": "{part} is held by {value} of its depth when it is open, at least {allowed} is needed",
    "range": "{part} moves by {value} (m or rad), allowed is {allowed}",
    "thin": "{part} has a piece {value} thin, at least {allowed} is needed",
    "crowded": "the body of {part} has {value} hulls or links, allowed is {allowed}",
    "tipping": "the middle of the object lies {value} outside of what {part} stands on, allowed is {allowed}",
    "unmet": "{part} needs {other} open, which does not move",
    "extent": "the {part} is {value} off what was asked, allowed is {allowed}",
    "adrift": "{part} carries all others and moves by {value} (m or rad), it must be fixed",
}
