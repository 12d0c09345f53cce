"""From parts to rigid bodies: welded parts, names of links and joints.

Every movable part becomes a link, in part order, together with everything fixed to it; the root part
with everything fixed to that is the last link and the root. Only where nothing moves is it fixed to an
empty link, `base`: SAPIEN takes a URDF without joints for a loose body, not for an articulation.
A screw part gets two links in a row: a carrier that turns and the part that travels on it.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from artigen.types import FULL_TURN, Asset, Joint, Part, PartLabel
from sim_export.errors import DegeneratePart, InvalidKinematics
from sim_export.package import (
    URDF_JOINT_TYPES,
    Hull,
    Inertial,
    Link,
    Mesh,
    PackageJoint,
    SimPackage,
    SourceMesh,
    UrdfJointType,
    Visual,
)
from sim_export.physics.inertia import check_inertial, combine, inertia_about, raise_light_mass
from sim_export.physics.materials import GRAVITY, joint_resistance
from sim_export.tree import hanging_links

BASE = "base"
MAX_LINKS = 64
HOLD_SLOPE = 0.09
LATCH_HOLD = 2.0
"""What holds a latch, over what gravity asks for: a spring does, and the leaf that leans on it pushes too."""
SHORTEST_DECAY = 0.1
"""Seconds; engines overdo damping that stops a body within a few steps of 1/60 s, so none is stronger."""
LEAST_TURNING = 1e-4
"""kg m^2; the least inertia about a joint that turns. A knob turns a shaft and a valve or gears with it,
which nobody models. A bare one of ten grams has a fiftieth of this, and fingers would give it more speed
in one step than contacts with its neighbours, which engines foresee a step ahead, can bear."""
LEAST_ROLLING = 6e-4
"""kg m^2; the same for wheels. A table rests on four castors of a few hundredths of its mass; without the
rims and axles that real ones have, contacts with the floor set them jumping at 1/60 s."""
CARRIER_MASS = 0.01
CARRIER_RADIUS = 0.02


@dataclass(frozen=True, kw_only=True, eq=False)
class PartGeometry:
    """What the earlier stages made of one part; metres, object frame at rest."""

    visuals: tuple[Mesh | SourceMesh, ...] = ()
    hulls: tuple[Hull, ...] = ()
    inertial: Inertial | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class LinkTree:
    """The links and joints of a package, and one sentence for everything that was adjusted."""

    links: tuple[Link, ...]
    joints: tuple[PackageJoint, ...]
    records: tuple[str, ...] = ()


def link_owners(asset: Asset) -> list[int]:
    """For every part, the part whose link it belongs to: its nearest movable ancestor or the root.

    Raises `InvalidKinematics` when the root itself has a joint, since nothing could hold it.
    """
    root = asset.parts[asset.root]
    if root.joint.type != "fixed":
        raise InvalidKinematics(
            f"asset {asset.name!r}: the root part {root.name!r} has a {root.joint.type} joint, expected fixed"
        )
    owners = []
    for index in range(len(asset.parts)):
        at = index
        while asset.parts[at].parent != -1 and asset.parts[at].joint.type == "fixed":
            at = asset.parts[at].parent
        owners.append(at)
    return owners


def link_names(asset: Asset) -> dict[int, str]:
    """Link name of every part that leads a link: movable parts in order, the root last."""
    leaders = [index for index in range(len(asset.parts)) if asset.parts[index].joint.type != "fixed"]
    return {part: f"link_{k}" for k, part in enumerate([*leaders, asset.root])}


def build_links(asset: Asset, geometry: Sequence[PartGeometry], latched: Collection[str] = ()) -> LinkTree:
    """Welds parts into links and turns part joints into package joints.

    Args:
        asset: The parts and joints; unit-cube lengths.
        geometry: Visuals, hulls and mass of every part, in the order of ``asset.parts``.
        latched: Names of parts that a latch of their own holds shut; their joints resist as free hinges and
            runners do, and need not hold them on a floor out of level.

    Raises:
        InvalidKinematics: If there would be more than 64 links, or the root part moves.
        DegeneratePart: If no part of a link has a mass.
        InvalidInertia: If a link's mass properties are not physical.
    """
    if len(geometry) != len(asset.parts):
        raise ValueError(
            f"asset {asset.name!r}: geometry of {len(geometry)} parts, it has {len(asset.parts)}"
        )
    owners, names = link_owners(asset), link_names(asset)
    links: list[Link] = []
    joints: list[PackageJoint] = []
    records: list[str] = []
    for leader, name in names.items():
        members = [leader, *(k for k, owner in enumerate(owners) if owner == leader and k != leader)]
        link, record = _weld(asset, geometry, members, name)
        records += record
        part = asset.parts[leader]
        if leader != asset.root:
            parent = names[owners[part.parent]]
            carriers, chain = _chain(asset, part, parent, link)
            links += carriers
            joints += chain
        links.append(link)
    if len(links) > MAX_LINKS:
        raise InvalidKinematics(
            f"asset {asset.name!r}: {len(links)} links, PhysX articulations have at most {MAX_LINKS}; "
            f"join small movable parts or drop them"
        )
    links, raised = _with_shafts(links, joints)
    if not joints:
        links.insert(0, Link(name=BASE, label=None, parts=(), visuals=(), hulls=(), inertial=None))
        joints.append(_fix(links[-1].name))
    return LinkTree(
        links=tuple(links),
        joints=_with_resistance(links, joints, frozenset(latched)),
        records=(*records, *raised),
    )


def _weld(
    asset: Asset, geometry: Sequence[PartGeometry], members: list[int], name: str
) -> tuple[Link, list[str]]:
    """One link out of its parts, the leader first."""
    visuals, count = [], {}
    for index in members:
        part = asset.parts[index]
        for mesh in geometry[index].visuals:
            k = count[part.label] = count.get(part.label, -1) + 1
            visuals.append(
                Visual(name=f"{part.label}_{name}_{k}", part=part.name, label=part.label, mesh=mesh)
            )
    leader = asset.parts[members[0]]
    masses = [geometry[index].inertial for index in members]
    known = [inertial for inertial in masses if inertial is not None]
    if not known:
        raise DegeneratePart(
            f"part {leader.name!r} ({name}) has no geometry with a mass, nor has anything on it"
        )
    inertial, record = raise_light_mass(combine(known), f"part {leader.name!r} ({name})")
    check_inertial(inertial, f"part {leader.name!r} ({name})")
    link = Link(
        name=name,
        label=leader.label,
        parts=tuple(asset.parts[index].name for index in members),
        visuals=tuple(visuals),
        hulls=tuple(hull for index in members for hull in geometry[index].hulls),
        inertial=inertial,
    )
    return link, [] if record is None else [record]


def _fix(child: str) -> PackageJoint:
    """The joint of a body that nothing moves on."""
    return PackageJoint(
        name=child.replace("link", "joint"),
        type="fixed",
        kind="fixed",
        parent=BASE,
        child=child,
        origin=np.zeros(3),
        axis=np.array([1.0, 0.0, 0.0]),
    )


def _chain(asset: Asset, part: Part, parent: str, link: Link) -> tuple[list[Link], list[PackageJoint]]:
    """The joint of a movable part; for a screw with a pitch also its carrier link and second joint."""
    joint, scale = part.joint, asset.scale
    origin = np.round(joint.origin * scale, 9)
    axis = joint.axis / np.linalg.norm(joint.axis)
    name = link.name.replace("link", "joint")
    if joint.type == "screw" and joint.pitch != 0.0:
        return _screw(joint, link, parent, scale)
    per_unit = scale if joint.type == "prismatic" else 1.0
    single = PackageJoint(
        name=name,
        type=_urdf_type(joint),
        kind=joint.type,
        parent=parent,
        child=link.name,
        origin=origin,
        axis=axis,
        lower=joint.lower * per_unit,
        upper=joint.upper * per_unit,
    )
    return [], [single]


def _urdf_type(joint: Joint) -> UrdfJointType:
    """A screw turns; more than one full turn has no URDF limits that every engine accepts."""
    if joint.type != "screw":
        return joint.type
    return "revolute" if joint.upper - joint.lower <= FULL_TURN + 1e-6 else "continuous"


def _screw(joint: Joint, link: Link, parent: str, scale: float) -> tuple[list[Link], list[PackageJoint]]:
    """Turn first, then travel: the travel's axis points so that its multiplier is positive."""
    per_radian = joint.pitch * scale
    origin = np.round(joint.origin * scale, 9)
    axis = joint.axis / np.linalg.norm(joint.axis)
    inertial = Inertial(
        mass=CARRIER_MASS, com=origin, inertia=0.4 * CARRIER_MASS * CARRIER_RADIUS**2 * np.eye(3)
    )
    carrier = Link(name=f"{link.name}_carrier", label=None, parts=(), visuals=(), hulls=(), inertial=inertial)
    name = link.name.replace("link", "joint")
    turn = PackageJoint(
        name=name,
        type=_urdf_type(joint),
        kind="screw",
        parent=parent,
        child=carrier.name,
        origin=origin,
        axis=axis,
        lower=joint.lower,
        upper=joint.upper,
    )
    travel = PackageJoint(
        name=f"{name}_travel",
        type="prismatic",
        kind="screw",
        parent=carrier.name,
        child=link.name,
        origin=origin,
        axis=axis * np.sign(per_radian),
        lower=joint.lower * abs(per_radian),
        upper=joint.upper * abs(per_radian),
        mimic=name,
        mimic_multiplier=abs(per_radian),
    )
    return [carrier], [turn, travel]


def subtree_inertial(links: Sequence[Link], joints: Sequence[PackageJoint], name: str) -> Inertial:
    """Mass properties, at rest, of a link and everything that hangs from it."""
    inside = hanging_links(joints, name)
    return combine([link.inertial for link in links if link.name in inside and link.inertial is not None])


def _with_shafts(links: Sequence[Link], joints: Sequence[PackageJoint]) -> tuple[list[Link], list[str]]:
    """Links whose inertia about their own joint is at least `LEAST_TURNING`; one sentence per change."""
    out, records = list(links), []
    turning = {joint.child: joint for joint in joints if joint.type in ("revolute", "continuous")}
    for index, link in enumerate(links):
        joint = turning.get(link.name)
        if joint is None or link.inertial is None:
            continue
        about = inertia_about(subtree_inertial(links, joints, link.name), joint.origin)
        least = LEAST_ROLLING if link.label == "wheel" else LEAST_TURNING
        missing = least - float(joint.axis @ about @ joint.axis)
        if missing > 0.0:
            # The same about every axis, so that the triangle inequality holds as before.
            heavier = replace(link.inertial, inertia=link.inertial.inertia + missing * np.eye(3))
            out[index] = replace(link, inertial=heavier)
            records.append(
                f"{link.name}: inertia about {joint.name} raised from {least - missing:.2g} to "
                f"{least:g} kg m^2, for the shaft that turns with it"
            )
    return out, records


def opening_pull(joint: PackageJoint, moved: Inertial, *, anywhere: bool = False) -> float:
    """The most with which gravity opens a closed joint on a floor out of level: N, or N m; 0 if it shuts it.

    With ``anywhere``, the most with which it turns the joint from any position, as for arms that stay put.

    Catches, seals and runners keep furniture shut where the floor slopes by 5 degrees in any direction;
    `HOLD_SLOPE` is a little more than that.
    """
    weight = moved.mass * GRAVITY
    arm = np.asarray(moved.com) - joint.origin
    moving = np.asarray(joint.axis) if joint.type == "prismatic" else np.cross(joint.axis, arm)
    if anywhere or joint.type == "continuous":  # any position may be the one it starts from
        return weight * float(np.linalg.norm(moving)) * (1.0 + HOLD_SLOPE)
    level = -weight * float(moving[2])
    return max(0.0, level + HOLD_SLOPE * weight * float(np.hypot(moving[0], moving[1])))


def _with_resistance(
    links: Sequence[Link], joints: Sequence[PackageJoint], latched: frozenset[str]
) -> tuple[PackageJoint, ...]:
    """Friction, damping, effort and velocity of every movable joint."""
    held = {link.name for link in links if latched & set(link.parts[:1])}
    labels: dict[str, PartLabel | None] = {link.name: link.label for link in links}
    leads = {joint.mimic: joint for joint in joints if joint.mimic is not None}
    out = []
    for joint in joints:
        follower = leads.get(joint.name)
        label = labels[follower.child if follower is not None else joint.child]
        if joint.type == "fixed" or label is None:
            out.append(joint)
            continue
        if joint.mimic is not None:  # the turning joint already resists for both
            out.append(replace(joint, friction=0.0, damping=0.0, effort=100.0, velocity=1.0))
            continue
        moved = subtree_inertial(links, joints, joint.child)
        stays = label == "handle" and joint.type == "revolute"  # arms of lamps, bails
        hold = 0.0 if joint.child in held else opening_pull(joint, moved, anywhere=stays)
        if joint.parent in held:  # a latch, on which its leaf leans
            hold *= LATCH_HOLD
        if follower is not None:  # a screw that stands upright locks, as threads do
            climb = abs(float(follower.axis[2])) * follower.mimic_multiplier
            hold += (1.0 + HOLD_SLOPE) * moved.mass * GRAVITY * climb
        resist = joint_resistance(label, joint.kind, moved.mass, hold)
        turning = float(joint.axis @ inertia_about(moved, joint.origin) @ joint.axis)
        moment = moved.mass if joint.type == "prismatic" else turning
        out.append(
            replace(
                joint,
                friction=resist.friction,
                damping=min(resist.damping, moment / SHORTEST_DECAY),
                effort=resist.effort,
                velocity=resist.velocity,
            )
        )
    return tuple(out)


def check_kinematics(package: SimPackage) -> None:
    """Raises `InvalidKinematics` unless links and joints form a tree that URDF can say.

    One root, unique names, known types, every joint between known links, finite numbers, unit axes,
    lower <= upper, at most 64 links.
    """
    owner = f"package {package.name!r}"
    names = [link.name for link in package.links]
    joints = [joint.name for joint in package.joints]
    visuals = [visual.name for link in package.links for visual in link.visuals]
    for kind, found in (("link", names), ("joint", joints), ("visual", visuals)):
        twice = sorted({name for name in found if found.count(name) > 1})
        if twice:
            raise InvalidKinematics(f"{owner}: {kind} names occur twice: {', '.join(twice)}")
        odd = [name for name in found if not name.replace("_", "").replace("-", "").isalnum()]
        if odd:
            raise InvalidKinematics(f"{owner}: {kind} name {odd[0]!r} is not made of letters, digits and _")
    if len(names) > MAX_LINKS:
        raise InvalidKinematics(f"{owner}: {len(names)} links, at most {MAX_LINKS} are allowed")
    children = [joint.child for joint in package.joints]
    roots = [name for name in names if name not in children]
    if len(roots) != 1 or len(children) != len(names) - 1 or len(set(children)) != len(children):
        raise InvalidKinematics(
            f"{owner}: {len(names)} links, {len(children)} joints, "
            f"roots {', '.join(roots) or 'none'}: not a tree"
        )
    for joint in package.joints:
        where = f"{owner}, joint {joint.name!r}"
        unknown = {joint.parent, joint.child} - set(names)
        if joint.mimic is not None:
            unknown |= {joint.mimic} - set(joints)
        if unknown:
            raise InvalidKinematics(f"{where}: names {', '.join(sorted(unknown))}, which is not there")
        if joint.type not in URDF_JOINT_TYPES:
            raise InvalidKinematics(f"{where}: type {joint.type!r}, allowed: {', '.join(URDF_JOINT_TYPES)}")
        numbers = [*joint.origin, *joint.axis, joint.lower, joint.upper]
        numbers += [joint.friction, joint.damping, joint.spring]
        if not np.isfinite(numbers).all():
            raise InvalidKinematics(
                f"{where}: origin, axis, limits or resistance hold NaN or infinite values"
            )
        if abs(np.linalg.norm(joint.axis) - 1.0) > 1e-6:
            raise InvalidKinematics(f"{where}: axis of length {np.linalg.norm(joint.axis):.9g}, expected 1")
        if joint.spring < 0.0 or (joint.spring > 0.0 and not joint.upper > 0.0):
            raise InvalidKinematics(f"{where}: a spring of {joint.spring} up to {joint.upper}: both above 0")
        if joint.lower > joint.upper:
            raise InvalidKinematics(f"{where}: lower {joint.lower} is above upper {joint.upper}")
    _check_reached(package, owner, roots[0])


def _check_reached(package: SimPackage, owner: str, root: str) -> None:
    """Every link hangs from the root: no cycle apart from it."""
    reached, front = {root}, [root]
    while front:
        front = [joint.child for joint in package.joints if joint.parent in front]
        reached |= set(front)
    lost = [link.name for link in package.links if link.name not in reached]
    if lost:
        raise InvalidKinematics(f"{owner}: links {', '.join(lost)} do not hang from {root!r}")
