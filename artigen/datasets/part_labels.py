"""Labels of parts: a table of names, and a table of joints for parts whose names are unknown.

The documentation shows `LABEL_TABLE` and `JOINT_TABLE`; a test keeps it equal. PartNet's names match as a
whole; names of links and joints in a URDF are searched for the words.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.datasets.partnet_annotation import MOVING_JOINTS, SourceNode
from artigen.types import PartLabel

SourceJoint = Literal["hinge", "slider"]
JointWord = Literal["hinge", "free hinge", "slider", "fixed"]

SPLIT_LABELS: dict[str, PartLabel] = {"handle": "handle", "knob": "knob"}
"""Pieces that become separate parts, fixed to the part that carries them."""

SPLIT_WORDS: dict[str, PartLabel] = {
    **SPLIT_LABELS,
    **dict.fromkeys(("grip", "pull", "bail"), "handle"),
    "shelf": "shelf",
}
"""The same by words in names of a URDF, without keys and switches, which are too many and too small."""

SHELF_NAMES: tuple[str, ...] = ("shelf",)
"""Pieces of the body that become fixed shelves."""


@dataclass(frozen=True)
class LabelRule:
    """Names that decide the label of a movable part, by the kind of its joint."""

    words: str
    hinge: PartLabel
    slider: PartLabel
    example: str

    @property
    def names(self) -> list[str]:
        return self.words.split()


@dataclass(frozen=True, kw_only=True)
class MovingPart:
    """Properties of a joint and of the part that it moves.

    Lengths are shares of the object's longest edge, heights of the object's height.
    """

    size: float
    """Longest edge of the part's box."""
    travel: float = 0.0
    """Range of a slider."""
    upright: bool = False
    """Whether the axis is nearer to the vertical than to the floor."""
    height: float = 0.5
    """Middle of the part above the floor."""
    parent: PartLabel = "base"
    parent_size: float = 1.0
    through_parent: bool = False
    """Whether the axis is nearer to the thinnest direction of the parent's box than to any other."""


@dataclass(frozen=True)
class JointRule:
    """A label for parts with unknown names, by joint, size and parent."""

    joint: JointWord
    label: PartLabel
    when: str
    holds: Callable[[MovingPart], bool]


LABEL_TABLE: tuple[LabelRule, ...] = (
    LabelRule(
        "drawer_front drawer_box drawer_bottom drawer_side drawer drw crisper",
        "door",
        "drawer",
        "a drawer; on a hinge, a drop front",
    ),
    LabelRule(
        "display_panel door_frame",
        "door",
        "drawer",
        "the front of a dishwasher or fridge; on a slider, a pull-out with a front",
    ),
    LabelRule(
        "cabinet_door cabinet_door_surface door surface_board glass translation rotation",
        "door",
        "door",
        "doors of cabinets, rooms, windows",
    ),
    LabelRule(
        "screen screen_side screen_frame board",
        "door",
        "door",
        "the lid of a laptop, the drop leaf of a table",
    ),
    LabelRule(
        "lid rotation_lid cover cap hatch flap gate shutter sash window leaf",
        "door",
        "door",
        "lids of boxes, pots, bottles; whatever closes an opening",
    ),
    LabelRule("wheel caster castor caster_stem tire tyre", "wheel", "wheel", "wheels, caster stems"),
    LabelRule(
        "tray shelf rack keyboard_tray_surface body_interior tray_support turntable platter plate basket",
        "tray",
        "tray",
        "racks, keyboard trays, turntables",
    ),
    LabelRule("seat_soft_surface back_soft_surface seat", "tray", "tray", "the seat of a chair"),
    LabelRule(
        "knob button control_button door_button toggle_button switch lock btn dial key "
        "toggle lever pedal latch valve trigger plunger nozzle",
        "knob",
        "knob",
        "whatever a finger turns or presses",
    ),
    LabelRule(
        "handle fixed_part grip pull bail spout tube",
        "handle",
        "handle",
        "handles that move; the spout of a faucet",
    ),
)
"""Rules in order of precedence: the first rule that contains one of a part's names decides. A part that they
call a handle is a knob if it is a `LEVER`."""

LEVER = JointRule(
    "hinge",
    "knob",
    "on a door, about an axis through its thickness, at most half as large as the door",
    lambda part: part.parent == "door" and part.through_parent and part.size <= 0.5 * part.parent_size,
)
"""Levers and handwheels of latches."""

JOINT_TABLE: tuple[JointRule, ...] = (
    LEVER,
    JointRule(
        "hinge",
        "handle",
        "on a door or drawer, at most half as large",
        lambda part: part.parent in ("door", "drawer") and part.size <= 0.5 * part.parent_size,
    ),
    JointRule(
        "hinge", "knob", "at most a quarter of the object's longest edge", lambda part: part.size <= 0.25
    ),
    JointRule("hinge", "door", "any other", lambda part: True),
    JointRule(
        "free hinge",
        "wheel",
        "level axis, middle in the lowest quarter of the object",
        lambda part: not part.upright and part.height <= 0.25,
    ),
    JointRule(
        "free hinge",
        "tray",
        "upright axis, at least half of the object's longest edge",
        lambda part: part.upright and part.size >= 0.5,
    ),
    JointRule("free hinge", "knob", "any other", lambda part: True),
    JointRule(
        "slider",
        "knob",
        "travels at most 5 % of the object's longest edge, or is no larger than 15 % of it",
        lambda part: part.travel <= 0.05 or part.size <= 0.15,
    ),
    JointRule("slider", "door", "travels up and down", lambda part: part.upright),
    JointRule("slider", "drawer", "any other", lambda part: True),
    JointRule("fixed", "base", "any", lambda part: True),
)
"""Rules in order of precedence for parts without a name in `LABEL_TABLE`."""


def choose_label(joint: SourceJoint, names: Sequence[str]) -> PartLabel | None:
    """Label of the first rule that contains one of a movable part's names."""
    for rule in LABEL_TABLE:
        if not set(names).isdisjoint(rule.names):
            return rule.hinge if joint == "hinge" else rule.slider
    return None


def find_word(name: str) -> str | None:
    """The table name that a free-form name contains: the last one, and the longest of those.

    ``leftDoorHandle_01`` contains ``handle``: the last word says what a thing is, those before it which one.
    """
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Za-z])(?=\d)", " ", name)
    words = [word for word in re.split(r"[^a-z]+", spaced.lower()) if word]
    known = {word for rule in LABEL_TABLE for word in rule.names}
    for end in range(len(words), 0, -1):
        for start in range(end):
            compound = "_".join(words[start:end])
            for spelled in (compound, compound.removesuffix("s"), compound.removesuffix("es")):
                if spelled in known:
                    return spelled
    return None


def label_by_joint(joint: JointWord, part: MovingPart) -> tuple[PartLabel, str]:
    """Label of a part with unknown names, and the condition that decided."""
    rule = next(rule for rule in JOINT_TABLE if rule.joint == joint and rule.holds(part))
    return rule.label, rule.when


def joint_word(node: SourceNode) -> JointWord:
    """The word of the tables for a node's joint."""
    if node.joint not in MOVING_JOINTS:
        return "fixed"
    if node.joint == "hinge":
        return "free hinge" if node.unlimited else "hinge"
    return "slider"


def measure_part(
    node: SourceNode,
    corners: Mapping[int, Float[np.ndarray, "N 3"]],
    labels: Mapping[int, PartLabel],
    T_zup_file: Float[np.ndarray, "4 4"],
) -> MovingPart:
    """Measures the properties of one node that the joint table uses.

    Args:
        corners: Corners of the triangles of every node in file coordinates.
        labels: Labels of the nodes so far, including the parent.
    """
    turn = T_zup_file[:3, :3]
    turned = {number: points @ turn.T for number, points in corners.items()}
    whole = np.concatenate(list(turned.values()))
    low, longest = whole.min(axis=0), float(np.ptp(whole, axis=0).max())
    own = turned[node.id]
    middle = float(own[:, 2].min() + own[:, 2].max()) / 2
    axis = turn @ np.array(node.direction)
    thinnest = int(np.ptp(turned[node.parent], axis=0).argmin())
    return MovingPart(
        size=float(np.ptp(own, axis=0).max()) / longest,
        travel=abs(node.b - node.a) / longest if node.joint == "slider" else 0.0,
        upright=bool(abs(axis[2]) > np.sqrt(0.5) * np.linalg.norm(axis)),
        height=(middle - float(low[2])) / max(float(np.ptp(whole[:, 2])), 1e-9),
        parent=labels[node.parent],
        parent_size=float(np.ptp(turned[node.parent], axis=0).max()) / longest,
        through_parent=int(np.abs(axis).argmax()) == thinnest,
    )


def _is_lever(
    label: PartLabel,
    node: SourceNode,
    corners: Mapping[int, Float[np.ndarray, "N 3"]],
    labels: Mapping[int, PartLabel],
    T_zup_file: Float[np.ndarray, "4 4"],
) -> bool:
    """Whether a part that its name calls a handle turns a latch; only hinged handles are measured."""
    if label != "handle" or node.joint != "hinge":
        return False
    return LEVER.holds(measure_part(node, corners, labels, T_zup_file))


def guess_label(
    node: SourceNode,
    names: Iterable[str],
    corners: Mapping[int, Float[np.ndarray, "N 3"]],
    labels: Mapping[int, PartLabel],
    T_zup_file: Float[np.ndarray, "4 4"],
) -> tuple[PartLabel, str]:
    """Label of a movable part and the reason: the first known name, else its joint."""
    joint = joint_word(node)
    for name in names:
        word = find_word(name)
        label = None if word is None else choose_label("slider" if joint == "slider" else "hinge", (word,))
        if label is not None:
            reason = repr(name) if name == word else f"{word!r} in {name!r}"
            if _is_lever(label, node, corners, labels, T_zup_file):
                return LEVER.label, f"{reason}, {LEVER.when}"
            return label, reason
    label, when = label_by_joint(joint, measure_part(node, corners, labels, T_zup_file))
    return label, f"{joint}, {when}"


def label_nodes(
    nodes: Sequence[SourceNode],
    corners: Mapping[int, Float[np.ndarray, "N 3"]],
    T_zup_file: Float[np.ndarray, "4 4"],
) -> tuple[dict[int, PartLabel], list[str]]:
    """Labels of all nodes by id, with a note for each node that was labelled by its joint.

    Args:
        nodes: Nodes, parents before children.
    """
    labels: dict[int, PartLabel] = {}
    notes = []
    for node in nodes:
        if node.parent == -1:
            labels[node.id] = "base"
            continue
        names = (node.name, *(piece.name for piece in node.pieces))
        joint = joint_word(node)
        kind: SourceJoint = "slider" if joint == "slider" else "hinge"
        known = None if joint == "fixed" else choose_label(kind, names)
        if known is not None:
            lever = _is_lever(known, node, corners, labels, T_zup_file)
            labels[node.id] = LEVER.label if lever else known
            continue
        labels[node.id], when = label_by_joint(joint, measure_part(node, corners, labels, T_zup_file))
        notes.append(
            f"node {node.id} ({node.name}): none of {', '.join(dict.fromkeys(names))} "
            f"is in the label table, labelled {labels[node.id]} for its {joint} ({when})"
        )
    return labels, notes
