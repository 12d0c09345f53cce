"""`build_from_reading`: what was read in a photograph becomes that very object."""

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.kind import kinds, name_kind
from artigen.reader.layout.cells import make_cells
from artigen.reader.layout.colours import find_finishes, tint_finish
from artigen.reader.layout.contents import furnish_node, simplify
from artigen.reader.layout.frontal import read_shape
from artigen.reader.layout.fronts import Lengths, View, settle_hinges, view_fronts
from artigen.reader.layout.nearest import draw_nearest
from artigen.reader.reading import Field, Reading
from artigen.shapes.draw import LENGTHS, CrowdedError, Wish, check_known, draw_shape
from artigen.shapes.fittings.feet import StandKind
from artigen.shapes.fittings.fronts import FrontStyle
from artigen.shapes.fittings.handles import HandleKind
from artigen.shapes.furniture.cabinet import list_cells
from artigen.shapes.furniture.case import FRAMED
from artigen.shapes.furniture.layouts import Layout
from artigen.shapes.furniture.splits import Cell, Node
from artigen.shapes.shape import Shape

FORMS: dict[str, tuple[HandleKind, ...]] = {"bar": ("bar", "pull", "arch"), "knob": ("knob",)}
"""Kinds of handles by the form that was read."""
PANELS: dict[Field, FrontStyle] = {"flat": "flat", "framed": "shaker", "slats": "louvre", "planks": "plank"}
"""Style of fronts by the field that was read."""
FLOOR = 0.03
"""Height (m) below the lowest front from which a flat stand is a plinth."""
PLINTH = 0.12
"""Greatest height (m) of a plinth."""
LEGS = (0.05, 0.35)
"""Least height (m) of legs, and the greatest as a share of the object's."""
WORKTOP = (0.015, 0.05)
"""Least and greatest thickness (m) of a worktop: thinner ones are the top of the case."""
MOST_FILES = 6
"""Drawers of a filing cabinet."""
MOST_CELLS = 40
"""Cells that an object may have: a drawer has at least six hulls, and engines hold 256."""
MOST_MERGES = 40
"""Steps in which cells are merged before an object is given up."""


@dataclass(frozen=True, kw_only=True)
class Foot:
    """What an object stands on."""

    kinds: tuple[StandKind, ...]
    height: float | None
    """Height (m); None for the usual one."""


def build_from_reading(
    reading: Reading, seed: int, wish: Wish | None = None
) -> tuple[Shape, tuple[str, ...]]:
    """The object of a reading: its fronts in their places, with its colours.

    Kinds that divide their front, such as furniture and refrigerators, are built at the first draw; of
    others, the most alike of several draws is taken. What cannot be seen, such as shelves behind doors,
    runners and mouldings, comes from the seed.

    Args:
        reading: What was read.
        seed: Seed of what was not read; the same arguments give the same object.
        wish: Lengths (m), style and handles that overrule the reading; lengths that
            are not given keep their proportions to one that is.

    Returns:
        The object, and in what it differs from the reading.

    Raises:
        ShapeError: If there is no such kind or style, or no object of the kind has the lengths.
    """
    wish, kind = wish or Wish(), reading.kind
    check_known(kind, wish)
    view = settle_hinges(
        view_fronts(reading, (wish.width, wish.depth, wish.height)), np.random.default_rng([seed, 64])
    )
    notes = (*view.notes, *_say_unbuilt(reading, kind))
    if kinds()[kind].laid_out and view.fronts:
        try:
            shape, more = _build_laid_out(reading, view, seed, wish)
            return wear_read(shape, reading, seed), (*notes, *more)
        except CrowdedError as error:
            notes = (*notes, str(error))
    size = view.size if reading.measured else _clip_size(kind, view)
    shape, _ = draw_nearest(reading, kind, seed, _prefer(wish, reading), size)
    return wear_read(shape, reading, seed), (*notes, *_say_difference(reading, shape))


def _build_laid_out(reading: Reading, view: View, seed: int, wish: Wish) -> tuple[Shape, tuple[str, ...]]:
    kind, notes = reading.kind, []
    if _needs_grips(reading):
        view = replace(view, fronts=tuple(replace(front, handles=1) for front in view.fronts))
        wish = replace(wish, handles=wish.handles or ("edge",))
        notes.append("no pull was read: fronts have grips in their edges")
    rng = np.random.default_rng([seed, 65])
    foot = find_foot(reading, view, kind)
    node = _lay_out(view, foot, kind)
    node = furnish_node(rng, node, (view.size[0], view.size[2] - (foot.height or 0.0)), view, kind)
    if kind == name_kind("filing cabinet") and not _is_stack(node):
        kind = name_kind("cabinet")
        notes.append(f"a filing cabinet is one stack of up to {MOST_FILES} drawers: built as {kind}")
    layout = Layout(
        node=node,
        stands=foot.kinds,
        stand_height=foot.height,
        gap=view.gap,
        worktop=_find_worktop(view),
        doors=_find_panel(reading, "door") if wish.style is None else None,
        drawers=_find_panel(reading, "drawer") if wish.style is None else None,
    )
    shape, merged = _draw(kind, seed, layout, view, _wish(reading, rng, view, wish))
    return shape, (*notes, *merged)


def _needs_grips(reading: Reading) -> bool:
    """Whether no pull was read on any front of a piece of furniture: what opens has a grip somewhere, and one
    in the edge of a front is hardly seen."""
    furniture = kinds()[reading.kind].trade == "furniture"
    return furniture and reading.counts["handle"] == 0 and not reading.bare


def wear_read(shape: Shape, reading: Reading, seed: int) -> Shape:
    """The object in the finishes that were read; things that are neither furniture nor appliances are of what
    their kind is made of, in the colours that were read."""
    worn = dict(shape.finishes)
    found = find_finishes(reading, seed)
    read = {role: own for role, own in (found | {"leg": found["body"]}).items() if role in worn}
    if kinds()[shape.category].trade not in ("furniture", "appliance"):
        read = {role: tint_finish(worn[role], own.color) for role, own in read.items()}
    return replace(shape, finishes=tuple(sorted((worn | read).items())))


def _clip_size(kind: str, view: View) -> Lengths:
    """The size that was read, as far as the kind has such sizes."""
    width, depth, height = (
        float(np.clip(length, *span)) for length, span in zip(view.size, kinds()[kind].sizes, strict=True)
    )
    return width, depth, height


def _prefer(wish: Wish, reading: Reading) -> Wish:
    """The wish with the kinds of handles that were read, where it names none."""
    return replace(wish, handles=wish.handles or FORMS[_find_form(reading)])


def _say_difference(reading: Reading, shape: Shape) -> tuple[str, ...]:
    """Doors and drawers that an object has too many or too few."""
    held = read_shape(shape).counts
    differs = [
        f"{held[label]} instead of {count} {label}s"
        for label, count in reading.counts.items()
        if label in ("door", "drawer") and held[label] != count
    ]
    return (f"the nearest {shape.category} that can be drawn has {', '.join(differs)}",) if differs else ()


def find_foot(reading: Reading, view: View, kind: str) -> Foot:
    """What the object stands on, and how high that is by what is below its lowest front."""
    height = view.size[2]
    below = height - max((float(front.bounds[3]) for front in view.fronts), default=height)
    if reading.stand == "wheels":
        return Foot(kinds=("castors",), height=None)
    if reading.stand == "legs":
        known = below >= LEGS[0]
        return Foot(kinds=("legs",), height=min(below, LEGS[1] * height) if known else None)
    if below < FLOOR or kind == name_kind("table"):
        return Foot(kinds=("floor",), height=None)
    return Foot(kinds=("plinth", "toe_kick"), height=min(below, PLINTH))


def _find_worktop(view: View) -> float:
    """Thickness (m) of a worktop in what is above the fronts; 0 for none."""
    above = min((float(front.bounds[1]) for front in view.fronts), default=0.0)
    return min(above, WORKTOP[1]) if above >= WORKTOP[0] else 0.0


def _lay_out(view: View, foot: Foot, kind: str) -> Node:
    if view.tree is None:
        return Cell(fill="open")
    width, _, height = view.size
    lowest = max(float(front.bounds[3]) for front in view.fronts)
    bottom = lowest if foot.height is None else height - foot.height
    region: Float[np.ndarray, "4"] = np.array([0.0, 0.0, width, max(bottom, lowest)])
    return make_cells(
        view.tree,
        view.fronts,
        region,
        framed=view.gap is not None and view.gap >= FRAMED,
        aside=kind == name_kind("table") or len(view.shelves) > 0,
    )


def _find_panel(reading: Reading, label: str) -> FrontStyle:
    """The commonest style of the doors or the drawers, slabs where nobody has looked."""
    fields: Counter[Field] = Counter(
        front.field for front in reading.fronts if front.label == label and front.field is not None
    )
    return PANELS[fields.most_common(1)[0][0]] if fields else "flat"


def _find_form(reading: Reading) -> str:
    """The commonest form of the handles, bars where none was read."""
    forms = Counter(part.form for part in reading.parts if part.label == "handle" and part.form is not None)
    return forms.most_common(1)[0][0] if forms else "bar"


def _wish(reading: Reading, rng: np.random.Generator, view: View, wish: Wish) -> Wish:
    preferred = FORMS[_find_form(reading)]
    width, depth, height = (float(np.clip(length, *LENGTHS)) for length in view.size)
    return Wish(
        width=width,
        depth=depth,
        height=height,
        style=wish.style,
        legs=wish.legs,
        handles=wish.handles or (preferred[int(rng.integers(len(preferred)))],),
    )


def _draw(kind: str, seed: int, layout: Layout, view: View, wish: Wish) -> tuple[Shape, tuple[str, ...]]:
    """The object with this layout, or the nearest one with fewer cells that engines can hold."""
    wanted = Counter(cell.fill for cell in list_cells(layout.node))
    while len(list_cells(layout.node)) > MOST_CELLS:
        fewer = simplify(layout, view.size)
        if fewer is None:
            break
        layout = fewer
    for _ in range(MOST_MERGES):
        try:
            shape = draw_shape(kind, seed, replace(wish, layout=layout))
        except (CrowdedError, ValueError) as error:  # too many solids, or a cell without room for its boards
            simpler = simplify(layout, view.size)
            if simpler is None:
                raise CrowdedError(
                    f"{kind}: its fronts cannot be built as they were read: {error}"
                ) from error
            layout = simpler
            continue
        held = Counter(cell.fill for cell in list_cells(layout.node))
        lost = [
            f"{held[fill]} instead of {count} cells with {fill}"
            for fill, count in wanted.items()
            if held[fill] != count
        ]
        return shape, (f"more than can be built: {', '.join(lost)}",) if lost else ()
    raise CrowdedError(f"{kind}: {sum(wanted.values())} cells are far more than engines hold")


def _is_stack(node: Node) -> bool:
    cells = list_cells(node)
    single = isinstance(node, Cell) or (node.along == "rows" and len(node.children) == len(cells))
    return single and len(cells) <= MOST_FILES and all(cell.fill == "drawer" for cell in cells)


def _say_unbuilt(reading: Reading, kind: str) -> list[str]:
    """What was read and is not built."""
    notes = []
    glazed = sum(front.label == "drawer" and front.pane for front in reading.fronts)
    dials = reading.counts["knob"] if kinds()[kind].trade == "furniture" else 0
    if glazed:
        notes.append(f"{glazed} glazed drawer{'s' * (glazed > 1)}: built without glass")
    if dials:
        notes.append(f"{dials} dial{'s' * (dials > 1)}: furniture has none, left out")
    return notes
