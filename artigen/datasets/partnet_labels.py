"""Maps PartNet's part names to our eight labels by one table.

A test keeps `LABEL_TABLE` and docs/reference/partnet_mobility.md equal.
"""

from dataclasses import dataclass
from typing import Literal

from artigen.datasets.partnet_annotation import MOVING_JOINTS, SourceNode
from artigen.types import PartLabel

SourceJoint = Literal["hinge", "slider"]

SPLIT_LABELS: dict[str, PartLabel] = {"handle": "handle", "knob": "knob"}
"""Content that becomes a part of its own, fixed to the part that carries it."""

SHELF_NAMES: tuple[str, ...] = ("shelf",)
"""Content of the body that becomes a fixed shelf."""

DEFAULT_LABELS: dict[str, PartLabel] = {
    "hinge": "door",
    "free hinge": "knob",
    "slider": "drawer",
    "fixed": "base",
}
"""Labels of parts whose names the table does not hold; a free hinge turns without limit."""


@dataclass(frozen=True, kw_only=True)
class LabelRule:
    """Names that decide the label of a movable part, by the kind of its joint (None: no decision)."""

    names: tuple[str, ...]
    hinge: PartLabel | None
    slider: PartLabel | None
    example: str


LABEL_TABLE: tuple[LabelRule, ...] = (
    LabelRule(
        names=("drawer_front", "drawer_box", "drawer_bottom", "drawer_side", "drawer"),
        hinge="door",
        slider="drawer",
        example="a drawer; on a hinge, a drop front",
    ),
    LabelRule(
        names=("display_panel", "door_frame"),
        hinge="door",
        slider="drawer",
        example="the front of a dishwasher or fridge; on a slider, a pull-out with a front",
    ),
    LabelRule(
        names=(
            "cabinet_door",
            "cabinet_door_surface",
            "door",
            "surface_board",
            "glass",
            "translation",
            "rotation",
        ),
        hinge="door",
        slider="door",
        example="doors of cabinets, rooms, windows",
    ),
    LabelRule(
        names=("screen", "screen_side", "screen_frame", "board"),
        hinge="door",
        slider="door",
        example="the lid of a laptop, the drop leaf of a table",
    ),
    LabelRule(
        names=("lid", "rotation_lid"), hinge="door", slider="door", example="lids of boxes, pots, bottles"
    ),
    LabelRule(
        names=("wheel", "caster", "caster_stem"),
        hinge="wheel",
        slider="wheel",
        example="wheels, caster stems",
    ),
    LabelRule(
        names=("tray", "shelf", "rack", "keyboard_tray_surface", "body_interior", "tray_support"),
        hinge="tray",
        slider="tray",
        example="racks, keyboard trays, turntables",
    ),
    LabelRule(
        names=("seat_soft_surface", "back_soft_surface"),
        hinge="tray",
        slider="tray",
        example="the seat of a chair",
    ),
    LabelRule(
        names=(
            "knob",
            "button",
            "control_button",
            "door_button",
            "toggle_button",
            "switch",
            "lock",
            "spout",
            "tube",
        ),
        hinge="knob",
        slider="knob",
        example="whatever a finger turns or presses; the spout of a faucet",
    ),
    LabelRule(names=("handle", "fixed_part"), hinge="handle", slider="handle", example="handles that move"),
)
"""Rules in order of precedence: the first rule that holds one of a part's names decides."""


def choose_label(joint: str, names: tuple[str, ...], *, free: bool) -> tuple[PartLabel, bool]:
    """Label of a part, and whether the table knew one of its names.

    Args:
        joint: ``hinge``, ``slider`` or ``fixed``.
        names: the part's own name and the names of its content.
        free: the hinge has no limits.
    """
    if joint != "fixed":
        for rule in LABEL_TABLE:
            label = rule.hinge if joint == "hinge" else rule.slider
            if label is not None and any(name in rule.names for name in names):
                return label, True
    return DEFAULT_LABELS["free hinge" if joint == "hinge" and free else joint], False


def label_nodes(nodes: tuple[SourceNode, ...]) -> tuple[dict[int, PartLabel], list[str]]:
    """Labels of all nodes by id, with a note for each that only a default could label."""
    labels: dict[int, PartLabel] = {}
    notes = []
    for node in nodes:
        if node.parent == -1:
            labels[node.id] = "base"
            continue
        names = (node.name, *(piece.name for piece in node.pieces))
        joint = node.joint if node.joint in MOVING_JOINTS else "fixed"
        labels[node.id], known = choose_label(joint, names, free=node.unlimited)
        if not known:
            notes.append(
                f"node {node.id} ({node.name}): none of {', '.join(dict.fromkeys(names))} "
                f"is in the label table, labelled {labels[node.id]} for its {joint}"
            )
    return labels, notes


def label_table_markdown() -> str:
    """The table as Markdown, for the documentation."""
    rows = [
        "| names, in order of precedence | on a hinge | on a slider | for instance |",
        "|---|---|---|---|",
    ]
    for rule in LABEL_TABLE:
        names = ", ".join(f"`{name}`" for name in rule.names)
        rows.append(f"| {names} | {rule.hinge or ''} | {rule.slider or ''} | {rule.example} |")
    rows.append(
        f"| none of these | {DEFAULT_LABELS['hinge']} ({DEFAULT_LABELS['free hinge']} without limits) "
        f"| {DEFAULT_LABELS['slider']} | recorded as a note |"
    )
    return "\n".join(rows) + "\n"
