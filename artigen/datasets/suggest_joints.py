"""Proposes the joints of a mesh file from the names of its nodes and their boxes.

Names say what a node is (`find_word`); a node that they do not name is a door or drawer where it closes the
front like a panel. Handles belong to what they are on, doors turn about the edge away from their handle,
drawers and trays come out to the front. All is a proposal, to be corrected.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from artigen.datasets.categories import guess_category
from artigen.datasets.joints_file import BODY, JointsFile, NodeJoint, Vector
from artigen.datasets.mechanism import Direction, unique_names
from artigen.datasets.mechanism_object import turn_upright
from artigen.datasets.mesh_files import Named, read_named
from artigen.datasets.part_labels import choose_label, find_word
from artigen.datasets.units import guess_unit
from artigen.errors import SourceError
from artigen.types import PartLabel

THIN = 0.15
"""A node that no name explains is a panel if it is at most this deep, as a share of the object's depth."""
NEAR = 0.05
"""What is on a part is at most this far from its box, as a share of the object's longest edge."""
TRAVEL = 0.75
"""Share of its depth by which a drawer comes out."""
TURN = 1.5708
KNOB_TURN = 4.7124
FRONT = 0.2
"""What closes the front begins at most this far behind the foremost handle, as a share of the depth."""
LID = 0.6
"""A door is a lid if it is on top and covers at least this share of the width and of the depth."""
BUTTONS = ("button", "btn", "key", "switch")
"""Words for what is pressed; other knobs are turned."""
PRESS = 0.3
"""Share of its height by which a button goes in."""
DROPS = ("oven", "dishwasher", "flap", "drop", "stove")
"""Words for doors that turn about their lower edge."""
SPINS = ("turntable", "platter")


@dataclass(frozen=True, kw_only=True, eq=False)
class _Node:
    """A node with its box, z up and front -x: lowest and highest corner."""

    name: str
    box: np.ndarray
    label: PartLabel | None

    @property
    def size(self) -> np.ndarray:
        return self.box[1] - self.box[0]

    @property
    def middle(self) -> np.ndarray:
        return self.box.mean(axis=0)


def suggest_joints(path: Path, up: Direction = "y", front: Direction = "z") -> JointsFile:
    """A proposal for the joints of a mesh file.

    Raises:
        SourceError: If the file cannot be read, or nothing in it looks as if it moved.
    """
    named, _ = read_named(path, path.parent)
    if not named:
        raise SourceError(f"{path}: holds no triangles")
    turn = turn_upright(up, front)[:3, :3]
    nodes = _list_nodes(named, turn)
    whole = _join_boxes(nodes)
    category, _ = guess_category([path.stem])
    metres, _ = guess_unit(whole[1] - whole[0], category)
    nodes = [_label_by_place(node, whole, len(nodes)) for node in nodes]
    movers = [node for node in nodes if node.label in ("door", "drawer", "tray", "wheel", "knob")]
    on: dict[str, list[_Node]] = {node.name: [] for node in movers}
    for node in nodes:
        holder = _find_holder(node, movers, whole)
        if holder is not None:
            on[holder.name].append(node)
    held = {node.name for own in on.values() for node in own}
    movers = [node for node in movers if node.name not in held]
    if not movers:
        names = ", ".join(node.name for node in nodes[:12])
        raise SourceError(
            f"{path}: none of its nodes ({names}) is called or placed like a part that moves; "
            "call them door, drawer, lid, knob, wheel or tray"
        )
    parts = unique_names([node.name if node.name != BODY else "part" for node in movers], "part")
    joints = [
        _propose(part, node, on[node.name], whole, drops=_drops(path.stem, node.name), turn=turn)
        for part, node in zip(parts, movers, strict=True)
    ]
    return JointsFile(joints=tuple(joints), up=up, front=front, metres=metres)


def _list_nodes(named: Sequence[Named], turn: np.ndarray) -> list[_Node]:
    """The nodes that may move: of the names of a mesh the outermost that says what it is, else the outermost
    that not all meshes share."""
    shared = set.intersection(*({*names} for names, _ in named)) if len(named) > 1 else set()
    boxes: dict[str, list[np.ndarray]] = {}
    for number, (names, mesh) in enumerate(named):
        own = [name for name in names if name not in shared] or list(names) or [f"node_{number}"]
        told = [name for name in own if find_word(name)]
        corners = np.asarray(mesh.vertices) @ turn.T
        boxes.setdefault((told or own)[-1], []).append(np.stack([corners.min(axis=0), corners.max(axis=0)]))
    return [
        _Node(name=name, box=_unite(own), label=_label_by_name(name)) for name, own in sorted(boxes.items())
    ]


def _unite(boxes: Sequence[np.ndarray]) -> np.ndarray:
    joined = np.stack(boxes)
    return np.stack([joined[:, 0].min(axis=0), joined[:, 1].max(axis=0)])


def _join_boxes(nodes: Sequence[_Node]) -> np.ndarray:
    return _unite([node.box for node in nodes])


def _label_by_name(name: str) -> PartLabel | None:
    word = find_word(name)
    if word is None or word == "shelf":
        return None
    if choose_label("slider", [word]) == "drawer":
        return "drawer"
    return choose_label("hinge", [word])


def _label_by_place(node: _Node, whole: np.ndarray, count: int) -> _Node:
    """The node, as a door or drawer if no name says what it is and it closes the front like one."""
    size = whole[1] - whole[0]
    if node.label is not None or find_word(node.name) or count < 2:
        return node
    in_front = node.box[0, 0] <= whole[0, 0] + FRONT * size[0]
    large = float(np.prod(node.size)) > 0.5 * float(np.prod(size))
    if not in_front or large or node.size[1:].min() < 2 * NEAR * size.max():
        return node
    label: PartLabel = (
        "drawer" if node.size[0] > THIN * size[0] or node.size[2] < 0.5 * node.size[1] else "door"
    )
    return _Node(name=node.name, box=node.box, label=label)


def _gap(one: np.ndarray, other: np.ndarray) -> float:
    """Distance of two boxes, 0 where they meet."""
    return float(np.linalg.norm(np.maximum(0.0, np.maximum(one[0] - other[1], other[0] - one[1]))))


def _find_holder(node: _Node, movers: Sequence[_Node], whole: np.ndarray) -> _Node | None:
    """The door or drawer that a handle, or a node within its box, belongs to."""
    longest = float((whole[1] - whole[0]).max())
    panels = [one for one in movers if one is not node and one.label in ("door", "drawer", "tray")]
    inside = [
        one
        for one in panels
        if (node.box[0] >= one.box[0] - NEAR * longest).all()
        and (node.box[1] <= one.box[1] + NEAR * longest).all()
        and np.prod(node.size) < np.prod(one.size)
        and not (one.label == "drawer" and node.label == "drawer")
    ]
    near = [one for one in panels if _gap(node.box, one.box) <= NEAR * longest] or inside
    if node.label == "knob":
        near = [one for one in near if _offset(node, one) == 0.0]
    if node.label == "handle" or (node.label == "knob" and near):
        return min(near, key=lambda one: _gap(node.box, one.box) + _offset(node, one), default=None)
    if node.label in ("wheel", "knob", "tray") or not inside:
        return None
    return min(inside, key=lambda one: float(np.prod(one.size)))


def _offset(node: _Node, panel: _Node) -> float:
    """How far the middle of a node is from a panel, across the front."""
    return _gap(np.stack([node.middle, node.middle])[:, 1:], panel.box[:, 1:])


def _drops(*names: str) -> bool:
    return any(word in name.lower() for word in DROPS for name in names)


def _propose(
    part: str, node: _Node, on: Sequence[_Node], whole: np.ndarray, *, drops: bool, turn: np.ndarray
) -> NodeJoint:
    """The joint of one part, in the frame of the file."""
    size, label = whole[1] - whole[0], node.label
    assert label is not None
    kind, origin, axis, upper = "prismatic", node.middle, np.array([-1.0, 0.0, 0.0]), 0.0
    if label in ("drawer", "tray") and not any(word in node.name.lower() for word in SPINS):
        depth = float(node.size[0])
        upper = TRAVEL * (depth if depth > 2 * THIN * size[0] else float(size[0]))
    elif label == "tray":
        kind, axis = "continuous", np.array([0.0, 0.0, 1.0])
    elif label == "wheel":
        kind, axis = "continuous", np.eye(3)[int(node.size.argmin())]
    elif label == "knob":
        kind, axis, upper = "revolute", _outward(node, whole), KNOB_TURN
        if any(word in node.name.lower() for word in BUTTONS):
            kind, axis, upper = "prismatic", -axis, PRESS * float(node.size.min())
    else:
        kind, upper = "revolute", TURN
        origin, axis = _hinge(node, on, whole, drops=drops)
    return NodeJoint(
        part=part,
        nodes=(node.name, *(other.name for other in on)),
        label=label,
        type=kind,
        origin=_vector(turn.T @ origin),
        axis=_vector(turn.T @ axis),
        lower=0.0,
        upper=round(upper, 5),
    )


def _vector(values: np.ndarray) -> Vector:
    x, y, z = (np.round(values, 5) + 0.0).tolist()
    return x, y, z


def _outward(node: _Node, whole: np.ndarray) -> np.ndarray:
    """Along the thinnest direction of a node, away from the middle of the object."""
    axis = int(node.size.argmin())
    sign = 1.0 if node.middle[axis] > whole[:, axis].mean() else -1.0
    return sign * np.eye(3)[axis]


def _hinge(
    node: _Node, on: Sequence[_Node], whole: np.ndarray, *, drops: bool
) -> tuple[np.ndarray, np.ndarray]:
    """A point and the direction of the hinge of a door or lid: at the outer face, which turns
    into nothing beside it."""
    cover = node.size / (whole[1] - whole[0])
    on_top = node.box[1, 2] >= whole[1, 2] - NEAR * float(np.ptp(whole, axis=0).max())
    out = np.array([0.0, 0.0, 1.0]) if on_top and cover[:2].min() >= LID else _outward(node, whole)
    thin = int(np.abs(out).argmax())
    point = node.middle.copy()
    point[thin] = node.box[1 if out[thin] > 0 else 0, thin]
    if thin == 2:  # a lid, which turns up about its back edge
        point[0], point[2] = node.box[1, 0], node.box[0, 2]
        return point, np.array([0.0, 1.0, 0.0])
    across = 1 - thin
    if drops:
        point[2], free = node.box[0, 2], np.array([0.0, 0.0, 1.0])
    else:
        side = _hinge_side(node, on, whole, across)
        point[across] = node.box[1 if side > 0 else 0, across]
        free = -side * np.eye(3)[across]
    return point, np.cross(free, out)


def _hinge_side(node: _Node, on: Sequence[_Node], whole: np.ndarray, across: int) -> float:
    """On which side of a door its hinge is: away from its handle, as its name says, or outside."""
    pulls = [other.middle[across] - node.middle[across] for other in on if other.label in ("handle", "knob")]
    if pulls and abs(np.mean(pulls)) > 0.1 * node.size[across]:
        return -float(np.sign(np.mean(pulls)))
    name = node.name.lower()
    if across == 1 and ("left" in name) != ("right" in name):  # as seen from the front, left is +y
        return 1.0 if "left" in name else -1.0
    aside = float(node.middle[across] - whole[:, across].mean())
    return float(np.sign(aside)) if abs(aside) > 0.1 * float(node.size[across]) else 1.0
