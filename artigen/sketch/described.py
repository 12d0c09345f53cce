"""`list_undescribed`: what words say and an object is not, beyond counts, sizes and finishes.

Words are compared with what a reader without error sees from the front (`artigen.reader.layout.frontal`).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

from artigen.conditioning.sentence import Placing
from artigen.conditioning.vocabulary import APART, STYLES, Feature, Spot
from artigen.reader.layout.frontal import read_shape
from artigen.reader.reading import Reading, ReadPart
from artigen.shapes.draw import Outline
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape

NARROW = 0.24
"""Width (m) of a front that is too narrow to be chosen where the object's width is free."""
LEVEL_SIDES = 0.97
"""Depth over width, or the other way round, from which a top is round or square."""
FULL, ELLIPSE = 0.97, 0.83
"""Shares of its rectangle that one with rounded corners fills at least, and a circle (0.785) at most."""
BESIDE = ("left", "right")
TOUCH = 0.02
"""Share of the front's width or height by which parts that are above or beside each other may overlap."""
ALIKE = 0.05
"""Difference of two places, as a share of the front, up to which they are one row or column."""
ASIDE = 0.1
"""Least distance from the middle, as a share of the front, of what is at a side and has no neighbour."""


def list_undescribed(
    shape: Shape, features: Sequence[Feature], places: Sequence[Placing], seen: Reading | None = None
) -> list[str]:
    """What is said and is not so; stands and kinds of legs and handles are not looked at.

    Args:
        shape: The object.
        features: Properties that are said.
        places: Places that are said.
        seen: Its front, as `read_front` gives it, if that is known.
    """
    reading = seen or read_front(shape)
    lost = [
        f"{part} {what} {value}"
        for part, what, value in features
        if not has_feature(shape, reading, (part, what, value))
    ]
    return lost + [
        f"{'glazed ' * place.pane}{place.label} at {place.at}"
        for place in places
        if not is_placed(reading, place, places)
    ]


def read_front(shape: Shape) -> Reading:
    """What is seen of a closed shape from the front: drawers behind doors are not."""
    reading = read_shape(shape)
    hidden = [
        one
        for one in reading.fronts
        if one.label == "drawer"
        and any(other.label == "door" and _covers(other.box, one.box) for other in reading.fronts)
    ]
    return replace(
        reading, parts=tuple(part for part in reading.parts if all(part is not one for one in hidden))
    )


def _covers(box: Float[np.ndarray, "4"], other: Float[np.ndarray, "4"]) -> bool:
    return bool((other[:2] >= box[:2] - TOUCH).all() and (other[2:] <= box[2:] + TOUCH).all())


def count_narrow(reading: Reading) -> int:
    """Fronts that are narrower than people make them."""
    wide = [reading.size[0] * float(front.box[2] - front.box[0]) for front in reading.fronts]
    return sum(width < NARROW for width in wide)


def has_feature(shape: Shape, reading: Reading, feature: Feature) -> bool:
    """Whether a shape that is read from the front has a property; True for what cannot be seen."""
    part, what, value = feature
    doors, fronts = _fronts(reading, "door"), reading.fronts
    style = STYLES.get(feature)
    if style is not None and style == shape.style:
        return True
    if (part, what) == ("door", "hinged"):  # the flap of a filter beside a door is another matter
        if feature == APART:
            doors.sort(key=lambda door: float(door.box[0]))
            return [door.hinge for door in (*doors[:1], *doors[-1:])] == ["left", "right"]
        sides = {door.hinge for door in doors if (door.hinge in BESIDE) == (value in BESIDE)}
        return sides == {value}
    if (part, what) == ("door", "material"):
        return bool(doors) and all(door.pane for door in doors)
    if (part, what, value) == ("door", "type", "side by side"):
        return len(doors) > 1 and all(_is_level(doors[0], door) for door in doors)
    if (part, what, value) == ("door", "type", "french"):
        pairs = [(a, b) for a in doors for b in doors if a.box[2] <= b.box[0] + TOUCH and _is_level(a, b)]
        return bool(pairs) and len(fronts) > 2
    if (part, what, value) == ("door", "type", "sliding"):
        moving = [one.joint for one in shape.parts if one.label == "door" and one.joint is not None]
        return bool(moving) and all(joint.type == "prismatic" for joint in moving)
    if what == "surface":
        return True  # of finishes that it wears later
    if what == "outline":
        found = find_outline(shape)
        return found == value or (found, value) == ("square", "rectangle")
    if part == "freezer":
        return _has_freezer(fronts, what, value)
    if what in ("columns", "rows"):
        axis = 0 if what == "columns" else 1
        return len(_group([one.box[axis] + one.box[axis + 2] for one in _fronts(reading, part)])) == int(
            value
        )
    if (part, what) == ("wheel", "type"):
        return any(one.label == "wheel" for one in shape.parts)
    return (part, what) in (("stand", "type"), ("leg", "type"), ("handle", "type"))


def find_outline(shape: Shape) -> Outline:
    """The outline from above of an object's top, or of all of it, by how much of its rectangle that fills."""
    solids = [solid for part in shape.parts for solid in part.primitives]
    top = [solid for solid in solids if solid.finish == "top"] or solids
    corners = np.concatenate([place_vertices(solid)[:, :2] for solid in top])
    sides = np.ptp(corners, axis=0)
    share = float(ConvexHull(corners).volume / sides.prod())
    level = float(sides.min() / sides.max()) > LEVEL_SIDES
    if share > FULL:
        return "square" if level else "rectangle"
    return "round" if level and share < ELLIPSE else "oval"


def is_placed(reading: Reading, place: Placing, places: Sequence[Placing]) -> bool:
    """Whether as many parts as are said are where they are said to be, and nothing else is."""
    if place.label == "shelf":
        return _is_open(reading, place.at)
    fronts = list(reading.fronts)
    own = _fronts(reading, place.label)
    elsewhere = any(other.label == place.label and other is not place for other in places)
    count = len(own) if place.count is None or not elsewhere else place.count
    if not 0 < count <= len(own):
        return False
    axis = 1 if place.at in ("top", "bottom") else 0
    own.sort(key=lambda front: float(front.box[axis] + front.box[axis + 2]))
    if place.at == "sides":
        half, others = len(own) // 2, [one for one in fronts if all(one is not mine for mine in own)]
        return _is_beyond(own[:half], others, "left") and _is_beyond(own[half:], others, "right")
    chosen = own[-count:] if place.at in ("bottom", "right") else own[:count]
    if place.pane and any(one.pane != any(one is mine for mine in chosen) for one in own):
        return False
    others = [one for one in fronts if all(one is not mine for mine in chosen)]
    if place.at == "middle":
        return any(_before(others, chosen, axis) and _after(others, chosen, axis) for axis in (0, 1))
    return _is_beyond(chosen, others, place.at)


def _is_beyond(chosen: Sequence[ReadPart], others: Sequence[ReadPart], at: Spot) -> bool:
    """Whether all of some fronts are above, below or beside all others, or, without others, at that side."""
    if not chosen:
        return False
    axis = 1 if at in ("top", "bottom") else 0
    sign = -1.0 if at in ("bottom", "right") else 1.0
    ends = [_span(front, axis, sign) for front in chosen]
    if others:
        return max(end for _, end in ends) <= min(_span(front, axis, sign)[0] for front in others) + TOUCH
    far = ASIDE if axis == 0 else 0.0
    return all((start + end) / 2 < sign * 0.5 - far for start, end in ends)


def _span(front: ReadPart, axis: int, sign: float) -> tuple[float, float]:
    low, high = float(front.box[axis]), float(front.box[axis + 2])
    return (low, high) if sign > 0 else (-high, -low)


def _before(others: Sequence[ReadPart], chosen: Sequence[ReadPart], axis: int) -> list[ReadPart]:
    low = min(float(front.box[axis]) for front in chosen)
    return [front for front in others if float(front.box[axis + 2]) <= low + TOUCH]


def _after(others: Sequence[ReadPart], chosen: Sequence[ReadPart], axis: int) -> list[ReadPart]:
    high = max(float(front.box[axis + 2]) for front in chosen)
    return [front for front in others if float(front.box[axis]) >= high - TOUCH]


def _is_open(reading: Reading, at: Spot) -> bool:
    """Whether a quarter of the front at a side, less what a stand or a top takes, has no front."""
    window = {
        "top": (0.0, 0.05, 1.0, 0.2), "bottom": (0.0, 0.75, 1.0, 0.85), "left": (0.0, 0.0, 0.2, 1.0),
        "right": (0.8, 0.0, 1.0, 1.0), "middle": (0.4, 0.4, 0.6, 0.6), "sides": (0.0, 0.0, 0.2, 1.0),
    }[at]  # fmt: skip
    left, top, right, bottom = window
    return not any(
        min(right, front.box[2]) > max(left, front.box[0])
        and min(bottom, front.box[3]) > max(top, front.box[1])
        for front in reading.fronts
    )


def _has_freezer(fronts: Sequence[ReadPart], what: str, value: str) -> bool:
    """Whether the lower one of two kinds of fronts, which is the freezer's, is where it is said to be."""
    rows = _group([float(front.box[1] + front.box[3]) for front in fronts])
    if len(rows) < 2:
        return False
    heights = [np.mean([fronts[at].box[3] - fronts[at].box[1] for at in row]) for row in rows]
    if what == "at":
        return (int(np.argmin(heights)) == 0) == (value == "top")
    return all(fronts[at].label == "drawer" for at in rows[-1])


def _group(twice: Sequence[float]) -> list[list[int]]:
    """Places, from the lowest, of numbers that are alike."""
    order = [int(at) for at in np.argsort(np.asarray(twice), kind="stable")]
    groups: list[list[int]] = []
    for at in order:
        if groups and twice[at] - twice[groups[-1][-1]] <= 2 * ALIKE:
            groups[-1].append(at)
        else:
            groups.append([at])
    return groups


def _is_level(one: ReadPart, other: ReadPart) -> bool:
    """Whether two fronts have the same upper and lower edges."""
    ends: Float[np.ndarray, "2"] = np.abs(one.box[[1, 3]] - other.box[[1, 3]])
    return bool((ends <= ALIKE).all())


def _fronts(reading: Reading, label: str) -> list[ReadPart]:
    return [front for front in reading.fronts if front.label == label]
