"""Converts the joints of a URDF to nodes: one node per moving joint; links joined by fixed joints are one.

Two joints in a row of which the second mimics the first along the same axis are a screw. Other mimics are
followers, which open and close with their leader.
"""

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from artigen.datasets.mechanism import Mechanism
from artigen.datasets.partnet_annotation import SourceNode
from artigen.errors import SourceError
from artigen.files.urdf import UrdfJoint
from artigen.types import FULL_TURN

ROUND = 1e-3
"""A revolute joint that exceeds a full turn by more than this (rad) becomes continuous."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Tree:
    """Nodes of a URDF; hinges are in degrees, ids follow the joints, and the body's id is the largest."""

    nodes: tuple[SourceNode, ...]
    owners: Mapping[str, int]
    """Node of every link that may have visuals."""
    joint_names: Mapping[int, str]
    follows: Mapping[int, int]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class _Coupling:
    """``q = ratio * q_leader``."""

    leader: str
    ratio: float


def build_tree(urdf: Mechanism, path: Path) -> Tree:
    """The nodes of a URDF, in its own frame at zero joint values.

    Raises:
        SourceError: If a joint is invalid; names the joint, its value and what is allowed.
    """
    notes: list[str] = []
    whole = _find_carriers(urdf)
    joints = {joint.name: _check(joint, whole, path, notes) for joint in urdf.joints}
    screws = _find_screws(joints, urdf)
    joints |= _simplify_chains(joints, frozenset((*screws, *screws.values())), urdf, notes)
    carriers = {joints[turn].child for turn in screws.values()}
    couplings = {
        joint.name: _resolve(joint, joints, path)
        for joint in joints.values()
        if joint.mimic is not None and joint.name not in screws and joint.type != "fixed"
    }
    above = {joint.child: joint for joint in joints.values()}
    ids = {name: number for number, name in enumerate(joints)}

    def owner(link: str) -> int:
        while link in above and (above[link].type == "fixed" or link in carriers):
            link = above[link].parent
        return ids[above[link].name] if link in above else len(ids)

    nodes = []
    for joint in joints.values():
        if joint.type == "fixed" or joint.child in carriers:
            continue
        turn = joints[screws[joint.name]] if joint.name in screws else joint
        coupling = couplings.get(joint.name)
        if coupling is not None:
            joint = _follow(joint, joints[coupling.leader], coupling, path)
        nodes.append(
            replace(_build_node(joint, turn, ids[joint.name], urdf, path), parent=owner(turn.parent))
        )
    nodes.append(SourceNode(id=len(ids), parent=-1, joint="heavy", name=urdf.root, pieces=()))
    return Tree(
        nodes=tuple(nodes),
        owners={link: owner(link) for link in urdf.links if link not in carriers},
        joint_names={ids[name]: name for name in joints},
        follows={ids[name]: ids[coupling.leader] for name, coupling in couplings.items()},
        notes=tuple(notes),
    )


def _find_carriers(urdf: Mechanism) -> set[str]:
    """Joints between the root and all that has a shape."""
    shown = {shape.link for shape in (*urdf.visuals, *urdf.collisions)}
    below = _list_below(urdf.joints)
    link, found = urdf.root, set[str]()
    while link not in shown:
        carrying = [joint for joint in below.get(link, ()) if _reaches(joint.child, shown, below)]
        if len(carrying) != 1:
            break
        found.add(carrying[0].name)
        link = carrying[0].child
    return found


def _list_below(joints: Iterable[UrdfJoint]) -> dict[str, list[UrdfJoint]]:
    """Joints by their parents."""
    below: dict[str, list[UrdfJoint]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint)
    return below


def _reaches(link: str, shown: Set[str], below: Mapping[str, Sequence[UrdfJoint]]) -> bool:
    """Whether a link or one below it has a shape."""
    waiting = [link]
    while waiting:
        at = waiting.pop()
        if at in shown:
            return True
        waiting += [joint.child for joint in below.get(at, ())]
    return False


def _check(joint: UrdfJoint, whole: Set[str], path: Path, notes: list[str]) -> UrdfJoint:
    """The joint with a type and limits that are valid for a part."""
    where = f"{path}: joint {joint.name!r}"
    if joint.type != "fixed" and joint.name in whole:
        notes.append(
            f"joint {joint.name!r} ({joint.type}) moves the whole object; it is fixed where it stands"
        )
        return replace(joint, type="fixed")
    if joint.type in ("floating", "planar"):
        raise SourceError(
            f"{where}: type {joint.type!r} cannot be kept, "
            "allowed are fixed, revolute, continuous and prismatic"
        )
    if joint.type == "fixed":
        return joint
    if not np.linalg.norm(joint.axis) > 1e-6:
        raise SourceError(f"{where}: axis {joint.axis.tolist()} has no length, expected a direction")
    if joint.type == "continuous":
        return joint
    lower, upper = joint.lower, joint.upper
    if lower is None or upper is None:
        if joint.mimic is not None:  # its leader limits it
            return joint
        raise SourceError(
            f"{where}: a {joint.type} joint with limits [{lower}, {upper}], expected <limit lower= upper=>, "
            "or type continuous where it turns without end"
        )
    if lower > upper:
        raise SourceError(f"{where}: lower {lower:g} is above upper {upper:g}")
    if joint.type == "revolute" and upper - lower > FULL_TURN + ROUND:
        notes.append(
            f"joint {joint.name!r} turns by {upper - lower:.3g} rad, more than once: made continuous"
        )
        return replace(joint, type="continuous")
    if not np.isfinite([lower, upper]).all():
        raise SourceError(f"{where}: limits [{lower:g}, {upper:g}] of a slider, expected finite numbers")
    if lower == upper and joint.mimic is None:
        notes.append(f"joint {joint.name!r}: limits [{lower:g}, {upper:g}] leave no motion, made fixed")
        return replace(joint, type="fixed")
    return joint


def _find_screws(joints: Mapping[str, UrdfJoint], urdf: Mechanism) -> dict[str, str]:
    """The sliding joint of every screw, with the turning joint that it mimics."""
    shown = {shape.link for shape in urdf.visuals}
    found = {}
    for joint in joints.values():
        turn = joints.get(joint.mimic or "")
        if joint.type != "prismatic" or turn is None or turn.type not in ("revolute", "continuous"):
            continue
        alone = sum(other.parent == turn.child for other in joints.values()) == 1
        if turn.child == joint.parent and turn.child not in shown and alone:
            found[joint.name] = turn.name
    return found


def _simplify_chains(
    joints: Mapping[str, UrdfJoint], screws: frozenset[str], urdf: Mechanism, notes: list[str]
) -> dict[str, UrdfJoint]:
    """Fixes all but one of the joints in a row through empty links, because a part has one joint.

    Fixed joints and branches without shapes between them do not break the row.

    The continuous joint stays, else the one that turns, else any; of several the one with the largest range,
    and of equal ranges the last.
    """
    shown = {shape.link for shape in (*urdf.visuals, *urdf.collisions)}
    below = _list_below(joints.values())
    following: dict[str, UrdfJoint] = {}
    for first in joints.values():
        if first.type == "fixed" or first.name in screws:
            continue
        at: UrdfJoint | None = first
        while at is not None and (at is first or at.type == "fixed"):
            after = [joint for joint in below.get(at.child, ()) if _reaches(joint.child, shown, below)]
            at = None if at.child in shown or len(after) != 1 else after[0]
        if at is not None and at.name not in screws:
            following[first.name] = at
    found: dict[str, UrdfJoint] = {}
    inner = {joint.name for joint in following.values()}
    for name in (name for name in following if name not in inner):
        chain = [joints[name]]
        while chain[-1].name in following:
            chain.append(following[chain[-1].name])
        kept = max(reversed(chain), key=_rank)
        found |= {
            joint.name: replace(joint, type="fixed", mimic=None) for joint in chain if joint is not kept
        }
        *others, last = (repr(joint.name) for joint in chain)
        links = ", ".join(repr(joint.child) for joint in chain[:-1])
        notes.append(
            f"joints {', '.join(others)} and {last} move one part through "
            f"the empty {'link' if len(chain) == 2 else 'links'} {links}; {kept.name!r} ({kept.type}) is kept"
        )
    return found


def _rank(joint: UrdfJoint) -> tuple[int, float]:
    """Which of several joints of one part says most about how it moves; the largest does."""
    order = ("prismatic", "revolute", "continuous").index(joint.type)
    return order, (joint.upper or 0.0) - (joint.lower or 0.0)


def _resolve(joint: UrdfJoint, joints: Mapping[str, UrdfJoint], path: Path) -> _Coupling:
    """The joint that a joint follows, directly or through other followers."""
    ratio, at, seen = 1.0, joint, {joint.name}
    while at.mimic is not None:
        ratio *= at.mimic_multiplier
        if at.mimic in seen:
            raise SourceError(f"{path}: joint {joint.name!r}: mimics {', '.join(sorted(seen))} form a cycle")
        seen.add(at.mimic)
        at = joints[at.mimic]
    if at.type not in ("revolute", "prismatic"):
        raise SourceError(
            f"{path}: joint {joint.name!r} mimics {at.name!r}, which is {at.type}; a part can only follow "
            "what moves between two limits: give that joint limits, or take <mimic> away"
        )
    return _Coupling(leader=at.name, ratio=ratio)


def _follow(joint: UrdfJoint, leader: UrdfJoint, coupling: _Coupling, path: Path) -> UrdfJoint:
    """The joint with the limits that its leader moves it to: lower at the leader's lower limit."""
    if coupling.ratio == 0.0:
        raise SourceError(f"{path}: joint {joint.name!r} mimics {leader.name!r} times 0, which moves nothing")
    ends = [coupling.ratio * (value or 0.0) for value in (leader.lower, leader.upper)]
    kind = "revolute" if joint.type == "continuous" else joint.type
    return replace(joint, type=kind, lower=ends[0], upper=ends[1])


def _build_node(joint: UrdfJoint, turn: UrdfJoint, number: int, urdf: Mechanism, path: Path) -> SourceNode:
    """A node without its parent; ``turn`` is the joint itself or the turning joint of a screw."""
    T = urdf.T_base_link[joint.child]
    direction = T[:3, :3] @ np.array(joint.axis)
    x, y, z = (direction / np.linalg.norm(direction)).tolist()
    start_x, start_y, start_z = T[:3, 3].tolist()
    slides = joint.type == "prismatic"
    lower, upper = joint.lower or 0.0, joint.upper or 0.0
    unit = 1.0 if slides else 180.0 / np.pi
    node = SourceNode(
        id=number,
        parent=-1,
        joint="slider" if slides else "hinge",
        name=joint.child,
        pieces=(),
        origin=(start_x, start_y, start_z),
        direction=(x, y, z),
        a=unit * lower,
        b=unit * upper,
        unlimited=joint.type == "continuous",
    )
    if turn is joint or turn.name == joint.name:
        return node
    axis = urdf.T_base_link[turn.child][:3, :3] @ np.array(turn.axis)
    pitch = joint.mimic_multiplier * float(np.sign(axis @ direction))
    if pitch <= 0.0:
        raise SourceError(
            f"{path}: joint {joint.name!r} follows {turn.name!r} as a left-handed screw, "
            "allowed are right-handed ones"
        )
    if turn.type == "revolute":
        lower, upper = sorted(joint.mimic_multiplier * (value or 0.0) for value in (turn.lower, turn.upper))
    degrees = float(np.degrees((upper - lower) / abs(joint.mimic_multiplier)))
    return replace(node, a=lower, b=upper, rotates=True, rotation_limit=degrees)
