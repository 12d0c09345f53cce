"""Phrases that refer to the moving parts of an object: "top left drawer", "lid", "second door from the left".

Parts that are called the same are told apart by where they are, seen from the front: cut into rows and
columns until each stands alone, as one would describe them. Every phrase refers to one part of the object.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.types import Joint
from sim_export.geometry.triangles import bounds_of
from sim_export.package import Link, SimPackage

Cut = Literal["row", "column", "layer"]
AXES: dict[Cut, tuple[int, float]] = {"row": (2, -1.0), "column": (1, -1.0), "layer": (0, 1.0)}
"""Axis, and its sign in the order of reading: from the top, from the left, from the front."""
ENDS: dict[Cut, tuple[str, str]] = {
    "row": ("top", "bottom"), "column": ("left", "right"), "layer": ("front", "back"),
}  # fmt: skip
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")
SHARED = 0.25
"""Share of the smaller of two extents that may overlap between rows, columns or layers."""
LEVEL = 0.8
"""Vertical part of the axis of a door below which it is level: a flap or a lid."""


@dataclass(frozen=True, kw_only=True)
class Phrases:
    """Ways to refer to the part that a link is, the shortest first."""

    link: str
    noun: str
    phrases: tuple[str, ...]


def name_parts(package: SimPackage, noun: str = "object") -> tuple[Phrases, ...]:
    """Phrases for every link that moves by itself, in the order of links.

    Args:
        noun: What the object is called, as in "top drawer of the dresser".
    """
    joints = {joint.child: joint for joint in package.joints if joint.type != "fixed"}
    moving = [(link, joints[link.name]) for link in package.links if link.name in joints and link.hulls]
    boxes = np.array([_box(link) for link, _ in moving]).reshape(-1, 2, 3)
    top = max((_box(link)[1, 2] for link in package.links if link.hulls), default=0.0)
    called = [_noun(link, joint, box, top) for (link, joint), box in zip(moving, boxes, strict=True)]
    found: dict[str, Phrases] = {}
    for word in dict.fromkeys(called):
        own = [index for index, each in enumerate(called) if each == word]
        for index, phrase in zip(own, tell_apart(word, boxes[own]), strict=True):
            link = moving[index][0].name
            found[link] = Phrases(link=link, noun=word, phrases=(phrase, f"{phrase} of the {noun}"))
    return tuple(found[link.name] for link, _ in moving)


def _noun(link: Link, joint: Joint, box: Float[np.ndarray, "2 3"], top: float) -> str:
    """What a part is called: a door is a lid where it lies on top, else a flap where its hinge is level."""
    if link.label == "door":
        height = box[1, 2] - box[0, 2]
        if height < box[1, 0] - box[0, 0] and box[1, 2] > top - height:
            return "lid"
        return "flap" if joint.type == "revolute" and abs(joint.axis[2]) < LEVEL else "door"
    return "part" if link.label in (None, "base") else str(link.label)


def _box(link: Link) -> Float[np.ndarray, "2 3"]:
    return bounds_of(np.concatenate([hull.vertices for hull in link.hulls]))


def tell_apart(noun: str, boxes: Float[np.ndarray, "N 2 3"]) -> list[str]:
    """One phrase for each of several boxes of the same noun, all different."""
    paths: list[list[tuple[Cut, int, int]]] = [[] for _ in boxes]
    _cut(list(range(len(boxes))), boxes, paths)
    return [_phrase(noun, path) for path in paths]


def _cut(members: Sequence[int], boxes: np.ndarray, paths: list[list[tuple[Cut, int, int]]]) -> None:
    """Extends the paths of some boxes by the cut that separates them, again and again."""
    if len(members) < 2:
        return
    separated: list[tuple[Cut, list[list[int]]]] = [
        (cut, _separate(members, boxes[:, :, axis] * sign)) for cut, (axis, sign) in AXES.items()
    ]
    # What overlaps in every direction is told apart by its order from the left.
    ordered = [[index] for index in sorted(members, key=lambda index: -float(boxes[index, :, 1].sum()))]
    apart: tuple[Cut, list[list[int]]] = "column", ordered
    cut, groups = next((found for found in separated if len(found[1]) > 1), apart)
    for number, group in enumerate(groups):
        for index in group:
            paths[index].append((cut, number, len(groups)))
        _cut(group, boxes, paths)


def _separate(members: Sequence[int], spans: Float[np.ndarray, "N 2"]) -> list[list[int]]:
    """Groups of spans along an axis that hardly overlap those of other groups, in order."""
    ordered = sorted(members, key=lambda index: float(spans[index].sum()))
    groups: list[list[int]] = []
    for index in ordered:
        if groups and any(_share(spans[index], spans[other]) > SHARED for other in groups[-1]):
            groups[-1].append(index)
        else:
            groups.append([index])
    return groups


def _share(first: Float[np.ndarray, "2"], second: Float[np.ndarray, "2"]) -> float:
    """Overlap of two spans as a share of the shorter one; ends may be in any order."""
    (a0, a1), (b0, b1) = np.sort(first), np.sort(second)
    return float((min(a1, b1) - max(a0, b0)) / max(min(a1 - a0, b1 - b0), 1e-9))


def _phrase(noun: str, path: Sequence[tuple[Cut, int, int]]) -> str:
    """A path of cuts in words: ends and middles before the noun, counts and further cuts behind it."""
    order: tuple[Cut, ...] = ("row", "layer", "column")
    steps = sorted(path, key=lambda step: order.index(step[0]))
    words = [_word(*step) for step in steps]
    if None not in words and len({cut for cut, _, _ in path}) == len(path):
        return " ".join([*(str(word) for word in words), noun])
    *outer, inner = path
    text = _counted(noun, *inner)
    words = [_word(*step) for step in sorted(outer, key=lambda step: order.index(step[0]))]
    if outer and None not in words and len({cut for cut, _, _ in outer}) == len(outer):
        return f"{text} at the {' '.join(str(word) for word in words)}"
    return " in the ".join([text, *(_counted(step[0], *step) for step in reversed(outer))])


def _word(cut: Cut, number: int, count: int) -> str | None:
    """Word for an end, or for the middle of three."""
    first, last = ENDS[cut]
    if number in (0, count - 1):
        return first if number == 0 else last
    return "middle" if count == 3 else None


def _counted(noun: str, cut: Cut, number: int, count: int) -> str:
    word = _word(cut, number, count)
    if word is not None:
        return f"{word} {noun}"
    return f"{_ordinal(number)} {noun} from the {ENDS[cut][0]}"


def _ordinal(number: int) -> str:
    return ORDINALS[number] if number < len(ORDINALS) else f"number {number + 1}"
