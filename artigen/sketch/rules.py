"""`Writer`: masks the next symbol so that every finished table is valid.

The header is a contract: every label occurs as often as it states, and every coordinate lies within its
extents. Parents precede their children, pieces use finishes of the table, and edges have positive length.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import ceil

import numpy as np
from jaxtyping import Bool, Int

from artigen.shapes.surfaces.finishes import FinishKind
from artigen.shapes.surfaces.palette import ROLES
from artigen.sketch.piece import INWARD, MAX_PIECES_OF_ARC, MIN_WEDGES, PIECE_KINDS, ROUND_SIDES, across
from artigen.sketch.request import RequestRows
from artigen.sketch.rows import (
    COUNTED,
    FIELDS,
    LENGTH,
    MATERIALS,
    MAX_PARTS,
    MAX_SIDES,
    MAY_FOLLOW,
    REACH,
    ROW_KINDS,
    WIDTH,
    column,
    fill_implied,
    find_implied,
    number_axes_by_kind,
)
from artigen.sketch.sketch import LEVELS, MAX_NEEDS, lowest_corner
from artigen.sketch.solid_pieces import room_to_cut
from artigen.sketch.words import list_styles
from artigen.types import JOINT_TYPES, PART_LABELS

MAX_ROWS = 220
MAX_PIECES = 32
"""Largest number of pieces of a part, which keeps the hulls of a body within what engines handle well."""
ACCENTS: Mapping[FinishKind, float] = {
    "wood": 0.78,
    "lacquer": 0.96,
    "steel": 0.87,
    "plastic": 0.96,
    "glass": 1.1,
    "rubber": 1.3,
    "stone": 0.8,
}
"""Brightness of the accent relative to a requested colour, as in `artigen.shapes.surfaces`."""
LEAST_EXTENT = 20
"""Smallest extent in steps (1 cm)."""
_ARCS = (*range(1, MAX_PIECES_OF_ARC + 1),)
SIDES: Mapping[str, tuple[int, ...]] = {
    "frustum": (4, *ROUND_SIDES),
    "ring": (*range(MIN_WEDGES, MAX_SIDES + 1),),
    "spokes": (*range(2, 9),),
    "slab": _ARCS,
    "shell": _ARCS,
    "elbow": _ARCS,
}
"""Allowed values of `Piece.sides`, by kind."""
LINED_SIDES: Mapping[str, tuple[int, ...]] = {
    "ring": (0, INWARD + 1),
    "plate": (0, INWARD + 1),
    "spokes": (0,),
    "shell": (*range(INWARD + 2),),
    "elbow": (0,),
}
"""Allowed lined sides, by kind; kinds that are not listed allow any side."""
_KIND = {kind: index for index, kind in enumerate(ROW_KINDS)}
_PIECE_IDS = [_KIND[kind] for kind in PIECE_KINDS]


@dataclass(kw_only=True, eq=False)
class Writer:
    """State of a table being written: call `allowed` before a symbol or `span` before a number, then
    `put`."""

    request: RequestRows
    rows: list[list[int]] = field(default_factory=list)
    row: list[int] = field(default_factory=list)
    """The current row, up to its next field."""
    labels: list[int] = field(default_factory=list)
    moving: list[bool] = field(default_factory=list)
    """Whether each finished part has a joint that moves."""

    def copy(self) -> "Writer":
        """An independent copy."""
        return replace(self, rows=[*self.rows], row=[*self.row], labels=[*self.labels], moving=[*self.moving])

    @property
    def done(self) -> bool:
        """Whether the table is closed."""
        return bool(self.rows) and self.rows[-1][0] == _KIND["end"]

    @property
    def stuck(self) -> bool:
        """Whether the table has reached `MAX_ROWS` without being closed."""
        return len(self.rows) >= MAX_ROWS and not self.done

    @property
    def delivered(self) -> bool:
        """Whether all parts that the header counts are present."""
        return bool(self.moving) and len(self.moving) == len(self.labels) and not any(self._left().values())

    @property
    def table(self) -> Int[np.ndarray, "T W"]:
        """The rows so far, with an end row if the table is open."""
        end = [_KIND["end"]] + [0] * (WIDTH - 1)
        return np.array(self.rows if self.done else [*self.rows, end])

    @property
    def kind(self) -> str:
        """Kind of the current row."""
        return ROW_KINDS[self.row[0]]

    @property
    def name(self) -> str:
        """Name of the next field."""
        return "kind" if not self.row else FIELDS[self.kind][len(self.row) - 1].name

    def value(self, name: str) -> int:
        """Value of a field of the current row."""
        return self.row[column(self.kind, name)]

    def complete(self) -> bool:
        """Whether the row has all its fields."""
        return bool(self.row) and len(self.row) == 1 + len(FIELDS[self.kind])

    def put(self, value: int) -> None:
        """Appends the value of the next field."""
        self.row.append(value)

    def follows(self) -> int | None:
        """Value of the next field if earlier fields imply it, else None."""
        if self.name not in MAY_FOLLOW:
            return None
        padded = self.padded()
        if self.name not in find_implied(padded):
            return None
        fill_implied(padded)
        return padded[len(self.row)]

    def axis(self) -> int:
        """Axis of the next field, as in `artigen.sketch.rows.number_axis`."""
        table, own = number_axes_by_kind()
        at = int(own[self.row[0]])
        return int(table[self.row[0], self.row[at] if 0 < at < len(self.row) else 0, len(self.row)])

    def place(self) -> dict[str, int]:
        """Position of the next number, as in `artigen.sketch.planes.Places`."""
        kind, at, axis, anchor = self.kind, len(self.row), self.axis(), self.anchor()
        piece = kind in PIECE_KINDS
        first = column(kind, "x0") if piece else 0
        sides = [*self.padded()[first : first + 6], 0, 0] if piece else [0] * 8
        return {
            "axis": axis,
            "low": sides[axis] if axis < LENGTH else 0,
            "high": sides[3 + axis] if axis < LENGTH else 0,
            "has_low": piece and at > first + axis,
            "has_high": piece and at > first + 3 + axis,
            "starts": piece and at == first + axis,
            "ends": piece and at == first + 3 + axis,
            "ranges": kind == "joint" and self.name == "upper",
            "anchor": 0 if anchor is None or axis == LENGTH else anchor[axis],
            "anchored": anchor is not None,
        }

    def anchor(self) -> list[int] | None:
        """Lowest corner of the current part's first piece; None before it."""
        count = self.length() if self.labels else 0
        if not count:
            return None
        first = column(ROW_KINDS[self.rows[-count][0]], "x0")
        return self.rows[-count][first : first + 3]

    def close(self) -> list[int]:
        """Closes the row and returns it, padded."""
        row = self.padded()
        if self.kind == "part":
            self.labels.append(row[1])
        elif self.kind == "joint":
            self.moving.append(row[1] > 0)
        self.rows.append(row)
        self.row = []
        return row

    def allowed(self, size: int) -> Bool[np.ndarray, "N"]:
        """Mask of allowed symbols among the ``size`` of the slot."""
        kind = "" if not self.row else self.kind
        forced = self._forced()
        can = np.zeros(size, dtype=bool)
        if forced is not None:
            can[forced] = True
        elif not kind:
            can[self._next_kinds()] = True
        elif kind == "object" and self.name == "style":
            can[list(list_styles(self.value("category")))] = True
        elif kind == "finish" and self.name == "role":
            can[self._next_roles()] = True
        elif kind == "object" and self.name in self.request.some:
            can[1:] = True
        elif kind == "part":
            can[self._next_labels() if self.name == "label" else self._next_parents()] = True
        elif kind in PIECE_KINDS and self.name in ("finish", "lining"):
            can[[row[1] for row in self.rows if row[0] == _KIND["finish"]]] = True
        elif kind in PIECE_KINDS and self.name in ("axis", "sides", "lined", "corners"):
            can[self._piece_choices(kind, size)] = True
        elif kind == "joint" and self.name in ("type", "need0", "need1", "holds"):
            can[self._joint_choices()] = True
        else:
            can[:] = True
        return can

    def span(self) -> tuple[int, int]:
        """Smallest and largest value of the next number."""
        name, kind, axis = self.name, self.kind, self.axis()
        forced = self._forced()
        if forced is not None:
            return forced, forced
        if kind == "object":
            return LEAST_EXTENT, REACH - 1
        if kind == "joint":
            return (1, REACH - 1) if axis == LENGTH else (1 - REACH, REACH - 1)
        if axis == LENGTH:
            return self._length_span(kind, name)
        low, high = self.bounds()[:, axis].tolist()
        start = {"x1": "x0", "y1": "y0", "z1": "z0"}.get(name)
        if kind == "frustum":
            start = start or {"u1": "u0", "v1": "v0"}.get(name)
        profile = kind == "prism" and axis != self.value("axis")
        if kind == "elbow" and start is not None:
            return self._elbow_span(start, high)
        if start is not None and not profile:
            return self.value(start) + 1, max(high, self.value(start) + 1)
        return low, high if profile or name in ("u1", "v1", "u3", "v3") else high - 1

    def bounds(self) -> Int[np.ndarray, "2 3"]:
        """Lowest and highest corner of the object."""
        first = column("object", "depth")
        extents = np.array(self.rows[0][first : first + 3])
        low = lowest_corner(extents)
        return np.stack([low, low + extents])

    def padded(self) -> list[int]:
        """The current row, with 0 for missing fields."""
        return self.row + [0] * (WIDTH - len(self.row))

    def _forced(self) -> int | None:
        """Value of the next field if the request fixes it."""
        if not self.row:
            return None
        request, at = self.request, len(self.row)
        if self.kind == "object" and request.known[0, at]:
            return int(request.rows[0, at])
        if self.kind == "finish" and self.name != "role":
            for row, known in zip(request.rows[1:], request.known[1:], strict=True):
                if row[1] != self.value("role"):
                    continue
                if known[at]:
                    return int(row[at])
                if self.name.startswith("accent_") and known[at - 3]:
                    share = ACCENTS[MATERIALS[self.value("material")]]
                    return min(round(share * int(row[at - 3])), LEVELS)
        return None

    def _left(self) -> dict[int, int]:
        """Number of missing parts of each label."""
        counted = self.rows[0][column("object", COUNTED[0]) :][: len(COUNTED)]
        return {label: count - self.labels.count(label) for label, count in enumerate(counted, start=1)} | {
            0: 1 - self.labels.count(0)
        }

    def length(self) -> int:
        """Number of rows of the current part after its ``part`` row."""
        return next(count for count, row in enumerate(reversed(self.rows)) if row[0] == _KIND["part"])

    def _next_kinds(self) -> list[int]:
        if not self.rows:
            return [_KIND["object"]]
        last = ROW_KINDS[self.rows[-1][0]]
        if last == "part":
            return _PIECE_IDS
        if last in PIECE_KINDS:
            full = self.length() >= MAX_PIECES
            return [_KIND["joint"]] if full else [*_PIECE_IDS, _KIND["joint"]]
        if last == "joint":
            return [_KIND["part"] if any(self._left().values()) else _KIND["end"]]
        if last == "object" or self._requested_roles():
            return [_KIND["finish"]]
        return [_KIND["part"], *([_KIND["finish"]] if self._next_roles() else [])]

    def _requested_roles(self) -> list[int]:
        """Requested roles that are still missing."""
        written = [row[1] for row in self.rows if row[0] == _KIND["finish"]]
        return sorted({int(row[1]) for row in self.request.rows[1:]} - set(written))

    def _next_roles(self) -> list[int]:
        """Next finish roles in order; a requested role is not skipped."""
        last = max((row[1] for row in self.rows if row[0] == _KIND["finish"]), default=-1)
        roles = self._requested_roles()
        return list(range(last + 1, (roles[0] if roles else len(ROLES) - 1) + 1))

    def _next_labels(self) -> list[int]:
        left = self._left()
        return [0] if left[0] else [label for label, count in left.items() if count > 0]

    def _next_parents(self) -> list[int]:
        if self.value("label") == PART_LABELS.index("base"):
            return [0]
        return list(range(1, min(len(self.labels), MAX_PARTS) + 1))

    def _piece_choices(self, kind: str, size: int) -> list[int]:
        if self.name == "axis":
            return [0, 2] if kind == "ring" else [0, 1, 2]
        if self.name == "corners":
            return [*range(kind == "slab", size)]  # a slab has at least one cut corner
        if self.name == "sides":
            return [*SIDES[kind]]
        return [*LINED_SIDES.get(kind, range(INWARD + 1))]

    def _joint_choices(self) -> list[int]:
        if self.name == "type":
            base = self.labels[-1] == PART_LABELS.index("base")
            return [0] if base else list(range(len(JOINT_TYPES)))
        movable = [index + 1 for index, moves in enumerate(self.moving) if moves]
        if self.name == "holds":
            return [0, *(index for index in movable if self._may_hold(index - 1))]
        taken = self.value("need0") if self.name == "need1" else 0
        return [0, *(index for index in movable if index != taken)]

    def _elbow_span(self, start: str, high: int) -> tuple[int, int]:
        """Range of an elbow's high side, at least the tube's thickness from its low side."""
        own, axis, first = self.value("axis"), self.axis(), column("elbow", "x0")
        sizes = {side: self.row[first + 3 + side] - self.row[first + side] for side in range(axis)}
        low = self.value(start)
        if axis == own:
            return low + 1, min([max(high, low + 1), *(low + size for size in sizes.values())])
        least = low + sizes.get(own, 1)
        return least, max(high, least)

    def _needs(self) -> list[set[int]]:
        """Required open parts of every finished part and of the part whose joint is being written."""
        found: list[set[int]] = [set() for _ in self.labels]
        joints = [row for row in self.rows if row[0] == _KIND["joint"]]
        for part, row in enumerate([*joints, self.padded()]):
            found[part] |= {row[column("joint", name)] - 1 for name in ("need0", "need1")} - {-1}
            if held := row[column("joint", "holds")]:
                found[held - 1].add(part)
        return found

    def _may_hold(self, held: int) -> bool:
        """Whether a new part may hold another without a cyclic or surplus requirement."""
        needs = self._needs()
        waits, open_ = {len(self.labels) - 1}, [len(self.labels) - 1]
        while open_:
            more = needs[open_.pop()] - waits
            waits |= more
            open_ += more
        return held not in waits and len(needs[held]) < MAX_NEEDS

    def _length_span(self, kind: str, name: str) -> tuple[int, int]:
        corners = np.array(self.row[column(kind, "x0") :][:6]).reshape(2, 3)
        sizes = corners[1] - corners[0]
        if name == "bevel":
            return 0, max((int(sizes.min()) - 1) // 2, 0)
        if kind == "plate":
            return 1, max(int(sizes[1:].min()) // 2 - 1, 1)
        u, v = across(self.value("axis"))
        if kind == "slab":
            room = room_to_cut(self.value("corners"))
            return 1, ceil(room[0] * sizes[u]) if name == "cut_u" else ceil(room[1] * sizes[v])
        if kind == "shell":
            return self._shell_span(name, int(sizes[u]), (int(min(sizes[u], sizes[v])) - 1) // 2)
        radius = int(sizes[u]) // 2
        if kind == "spokes":
            return 1, max(radius - 1, 1)
        flat = np.cos(np.pi / max(self.value("sides"), 3))
        if name == "outer0":
            return int(self.value("inner0") / flat) + 2, 2 * max(radius, self.value("inner0")) + 2
        # The bounds are those of a ring's far end; the near end may be wider.
        return 1, max(int((3 if name == "inner0" else 1) * radius * flat) - 1, 1)

    def _shell_span(self, name: str, length: int, room: int) -> tuple[int, int]:
        """Range of a shell's number for its length along u and the room within each of its sides."""
        if name == "cut0":
            return 1, max(length - 1, 1)
        if name == "cut1":
            return 1, max(length - self.value("cut0"), 1)
        return (-room, room) if name == "inset" else (0, room - abs(self.value("inset")))
