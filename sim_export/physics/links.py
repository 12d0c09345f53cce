"""Builds rigid bodies from parts: welds parts, names links and joints.

Every movable part, with all parts fixed to it, becomes a link, in part order. The root part with everything
fixed to it is the last link and the root. If nothing moves, it is fixed to an empty link, `base`, because
SAPIEN loads a URDF without joints as a free body and not as an articulation. A screw part becomes two links
in a row: a turning intermediate link, and the part that travels along it.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.types import FULL_TURN, Asset, Joint, Part
from sim_export.errors import DegeneratePart, InvalidKinematics
from sim_export.motion.kinematics import hanging_links
from sim_export.package import (
    URDF_JOINT_TYPES,
    Hull,
    Inertial,
    Link,
    Mesh,
    SimPackage,
    SourceMesh,
    UrdfJointType,
    Visual,
)
from sim_export.physics.inertia import (
    check_inertial,
    combine,
    inertia_about,
    least_mass,
    raise_light_mass,
    subtree_inertial,
)
from sim_export.physics.resistance import resist_joints

BASE = "base"
MAX_LINKS = 64
LEAST_TURNING = 1e-4
"""Smallest inertia (kg m^2) about a turning joint. A knob turns a shaft and a valve or gears, which are not
modelled. A bare knob of ten grams has a fiftieth of this. Fingers would accelerate it in one step beyond what
contacts with its neighbours, which engines predict one step ahead, can handle."""
LEAST_ROLLING = 6e-4
"""The same for wheels (kg m^2). A table rests on four castors with a few hundredths of its mass; without the
rims and axles of real castors, contacts with the floor make them jump at a step of 1/60 s."""
CARRIER_MASS = 0.01
CARRIER_RADIUS = 0.02


@dataclass(frozen=True, kw_only=True, eq=False)
class PartGeometry:
    """Geometry of one part from earlier stages; metres, object frame at rest.

    ``finishes`` are the roles of the visuals, if these show a part by its surfaces. ``visual_error`` as in
    `Link`.
    """

    visuals: tuple[Mesh | SourceMesh, ...] = ()
    finishes: tuple[str, ...] = ()
    hulls: tuple[Hull, ...] = ()
    inertial: Inertial | None = None
    visual_error: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class LinkTree:
    """The links and joints of a package, with one sentence per adjustment."""

    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    records: tuple[str, ...] = ()


def link_owners(asset: Asset) -> list[int]:
    """For every part, the part that leads its link: its nearest movable ancestor or the root.

    Raises `InvalidKinematics` if the root itself has a joint.
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


def link_surfaces(
    asset: Asset, surfaces: Sequence[Float[np.ndarray, "F 3 3"]]
) -> dict[str, Float[np.ndarray, "F 3 3"]]:
    """Triangles of every link that has any, from those of all parts."""
    owners = link_owners(asset)
    found = {
        name: np.concatenate([s for s, owner in zip(surfaces, owners, strict=True) if owner == part])
        for part, name in link_names(asset).items()
    }
    return {name: triangles for name, triangles in found.items() if len(triangles)}


def build_links(
    asset: Asset, geometry: Sequence[PartGeometry], latched: Collection[str] = (), stays: Collection[str] = ()
) -> LinkTree:
    """Welds parts into links and converts part joints to package joints.

    Args:
        asset: The parts and joints; unit-cube lengths.
        geometry: Visuals, hulls and mass of every part, in the order of ``asset.parts``.
        latched: Names of parts held shut by a latch. Their joints have only the friction of free hinges and
            runners, and need not hold them on a sloping floor.
        stays: Names of parts whose hinges hold them wherever they are left.

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
    joints: list[Joint] = []
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
        links.insert(0, Link(name=BASE))
        joints.append(_fix(links[-1].name))
    resisting = resist_joints(links, joints, frozenset(latched), frozenset(stays))
    balanced = [
        f"{joint.name}: a spring counterbalances it with {abs(joint.spring):.3g}, at its upper limit with "
        f"{abs(joint.pull(joint.upper)):.3g} (N or N m); URDF cannot say so"
        for joint in resisting
        if joint.spring != 0.0
    ]
    return LinkTree(links=tuple(links), joints=resisting, records=(*records, *raised, *balanced))


def _weld(
    asset: Asset, geometry: Sequence[PartGeometry], members: list[int], name: str
) -> tuple[Link, list[str]]:
    """Builds one link from its parts, the leader first."""
    visuals, count = [], {}
    for index in members:
        part = asset.parts[index]
        own = geometry[index]
        for number, mesh in enumerate(own.visuals):
            if not (own.finishes and number):
                count[part.label] = count.get(part.label, -1) + 1
            finish = own.finishes[number] if own.finishes else ""
            stem = f"{part.label}_{name}_{count[part.label]}"
            visuals.append(
                Visual(
                    name=f"{stem}-{number}" if finish and number else stem,
                    part=part.name,
                    label=part.label,
                    mesh=mesh,
                    finish=finish,
                )
            )
    leader = asset.parts[members[0]]
    errors = [geometry[index].visual_error for index in members]
    masses = [geometry[index].inertial for index in members]
    known = [inertial for inertial in masses if inertial is not None]
    if not known:
        raise DegeneratePart(
            f"part {leader.name!r} ({name}) has no geometry with a mass, nor has anything on it"
        )
    whole = sum(own.inertial.mass for own in geometry if own.inertial is not None)
    least = least_mass(whole, asset.scale)
    inertial, record = raise_light_mass(combine(known), f"part {leader.name!r} ({name})", least)
    check_inertial(inertial, f"part {leader.name!r} ({name})")
    link = Link(
        name=name,
        label=leader.label,
        parts=tuple(asset.parts[index].name for index in members),
        visuals=tuple(visuals),
        hulls=tuple(hull for index in members for hull in geometry[index].hulls),
        inertial=inertial,
        visual_error=max((error for error in errors if error is not None), default=None),
    )
    return link, [] if record is None else [record]


def _fix(child: str) -> Joint:
    """The fixed joint of an object without moving parts."""
    return Joint(
        name=child.replace("link", "joint"),
        type="fixed",
        parent=BASE,
        child=child,
        axis=np.array([1.0, 0.0, 0.0]),
    )


def _chain(asset: Asset, part: Part, parent: str, link: Link) -> tuple[list[Link], list[Joint]]:
    """The joint of a movable part; for a screw with a pitch also its intermediate link and second joint."""
    joint, scale = part.joint, asset.scale
    per_unit = scale if joint.type == "prismatic" else 1.0
    single = Joint(
        name=link.name.replace("link", "joint"),
        type=_urdf_type(joint),
        of_screw=joint.type == "screw",
        parent=parent,
        child=link.name,
        origin=np.round(joint.origin * scale, 9),
        axis=joint.axis / np.linalg.norm(joint.axis),
        lower=joint.lower * per_unit,
        upper=joint.upper * per_unit,
    )
    if joint.type == "screw" and joint.pitch != 0.0:
        return _screw(single, link, joint.pitch * scale)
    return [], [single]


def _urdf_type(joint: Joint) -> UrdfJointType:
    """URDF joint type. A screw turns; more than one full turn has no URDF limits that every engine
    accepts."""
    if joint.type != "screw":
        return joint.type
    return "revolute" if joint.upper - joint.lower <= FULL_TURN + 1e-6 else "continuous"


def _screw(turn: Joint, link: Link, per_radian: float) -> tuple[list[Link], list[Joint]]:
    """Turning joint, then sliding joint with its axis oriented so that the multiplier is positive."""
    inertial = Inertial(
        mass=CARRIER_MASS, com=turn.origin, inertia=0.4 * CARRIER_MASS * CARRIER_RADIUS**2 * np.eye(3)
    )
    carrier = Link(name=f"{link.name}_carrier", inertial=inertial)
    travel = replace(
        turn,
        name=f"{turn.name}_travel",
        type="prismatic",
        parent=carrier.name,
        axis=turn.axis * np.sign(per_radian),
        lower=turn.lower * abs(per_radian),
        upper=turn.upper * abs(per_radian),
        follows=turn.name,
        ratio=abs(per_radian),
    )
    return [carrier], [replace(turn, child=carrier.name), travel]


def _with_shafts(links: Sequence[Link], joints: Sequence[Joint]) -> tuple[list[Link], list[str]]:
    """Raises the inertia of links about their own joint to at least `LEAST_TURNING`; one sentence per
    change."""
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
            # Add the same about every axis, which preserves the triangle inequality.
            heavier = replace(link.inertial, inertia=link.inertial.inertia + missing * np.eye(3))
            out[index] = replace(link, inertial=heavier)
            records.append(
                f"{link.name}: inertia about {joint.name} raised from {least - missing:.2g} to "
                f"{least:g} kg m^2, for the shaft that turns with it"
            )
    return out, records


def check_kinematics(package: SimPackage) -> None:
    """Raises `InvalidKinematics` unless links and joints form a tree that URDF can express.

    Requires one root, unique names, known types, joints between known links, and at most 64 links.
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
        if joint.follows is not None:
            unknown |= {joint.follows} - set(joints)
        if unknown:
            raise InvalidKinematics(f"{where}: names {', '.join(sorted(unknown))}, which is not there")
        if joint.type not in URDF_JOINT_TYPES:
            raise InvalidKinematics(f"{where}: type {joint.type!r}, allowed: {', '.join(URDF_JOINT_TYPES)}")
        if joint.spring != 0.0 and not joint.upper > 0.0:
            raise InvalidKinematics(
                f"{where}: a spring of {joint.spring} up to {joint.upper}, expected above 0"
            )
    lost = set(names) - hanging_links(package.joints, roots[0])
    if lost:
        raise InvalidKinematics(f"{owner}: links {', '.join(sorted(lost))} do not hang from {roots[0]!r}")
