"""Joints of OpenUSD: what they connect, where, their limits and leaders; as joints of a mechanism."""

# usd-core has no type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

import re
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.errors import SourceError
from artigen.files.urdf import UrdfJoint, weld
from artigen.transforms import inverse, matrix_from_quat

if TYPE_CHECKING:
    from pxr import Usd

WORLD = "/"
"""Path of what belongs to no rigid body."""
KINDS = {
    "PhysicsFixedJoint": "fixed",
    "PhysicsRevoluteJoint": "revolute",
    "PhysicsPrismaticJoint": "prismatic",
}
PHYSX_MIMIC = re.compile(r"(physxMimicJoint:\w+):referenceJoint")


@dataclass(frozen=True, kw_only=True, eq=False)
class Edge:
    """A joint between two bodies, by path; the frame of the joint on each of them in the world."""

    path: str
    type: str
    bodies: tuple[str, str]
    T_world_joint: tuple[Float[np.ndarray, "4 4"], Float[np.ndarray, "4 4"]]
    axis: Float[np.ndarray, "3"]
    """In the frame of the joint on the first body."""
    limits: tuple[float, float]
    mimic: tuple[str, float, float] | None
    """Path of the leader, factor and offset."""


def body_of(prim: "Usd.Prim") -> str:
    """Path of the rigid body that a prim belongs to."""
    from pxr import UsdPhysics

    while prim and not prim.IsPseudoRoot():
        enabled = prim.GetAttribute("physics:rigidBodyEnabled").Get()
        if prim.HasAPI(UsdPhysics.RigidBodyAPI) and enabled is not False:
            return str(prim.GetPath())
        prim = prim.GetParent()
    return WORLD


def world_pose(prim: "Usd.Prim") -> Float[np.ndarray, "4 4"]:
    """The map from a prim's coordinates to those of the stage."""
    from pxr import Usd, UsdGeom

    return np.array(UsdGeom.XformCache(Usd.TimeCode.Default()).GetLocalToWorldTransform(prim)).T


def read_joint(prim: "Usd.Prim", T_zup_stage: np.ndarray, unused: Counter[str]) -> Edge | None:
    """A joint; None and a count for one that binds nothing, or only keeps a distance."""
    from pxr import UsdPhysics

    joint, stage = UsdPhysics.Joint(prim), prim.GetStage()
    kind = prim.GetTypeName()
    if kind == "PhysicsDistanceJoint":
        unused["distance joints"] += 1
        return None
    bodies, frames = [], []
    for number, said in enumerate((joint.GetBody0Rel(), joint.GetBody1Rel())):
        targets = said.GetForwardedTargets()
        target = stage.GetPrimAtPath(targets[0]) if targets else stage.GetPseudoRoot()
        if not target:
            unused["joints of bodies that are not there"] += 1
            return None
        position = prim.GetAttribute(f"physics:localPos{number}").Get()
        turn = prim.GetAttribute(f"physics:localRot{number}").Get()
        w, (x, y, z) = turn.GetReal(), turn.GetImaginary()
        frames.append(
            _joint_frame(T_zup_stage @ world_pose(target), np.array(position), np.array([w, x, y, z]))
        )
        bodies.append(body_of(target))
    if bodies[0] == bodies[1]:
        unused["joints within one body"] += 1
        return None
    axis = (
        np.eye(3)["XYZ".index(prim.GetAttribute("physics:axis").Get() or "X")]
        if kind in KINDS
        else np.zeros(3)
    )
    unit = np.pi / 180.0 if kind == "PhysicsRevoluteJoint" else float(np.linalg.norm(T_zup_stage[:3, 0]))
    limits = (-np.inf, np.inf)
    if kind in ("PhysicsRevoluteJoint", "PhysicsPrismaticJoint"):
        low, high = (unit * prim.GetAttribute(f"physics:{side}Limit").Get() for side in ("lower", "upper"))
        limits = (float(low), float(high))
    return Edge(
        path=str(prim.GetPath()),
        type=KINDS.get(kind, kind),
        bodies=(bodies[0], bodies[1]),
        T_world_joint=(frames[0], frames[1]),
        axis=axis,
        limits=limits,
        mimic=_read_mimic(prim),
    )


def _joint_frame(T: np.ndarray, position: np.ndarray, quat: np.ndarray) -> Float[np.ndarray, "4 4"]:
    """Rigid frame of a joint in the world, on a body whose map to the world may scale."""
    frame = np.eye(4)
    lengths = np.linalg.norm(T[:3, :3], axis=0)
    frame[:3, :3] = (T[:3, :3] / lengths) @ matrix_from_quat(quat[None] / np.linalg.norm(quat))[0]
    frame[:3, 3] = T[:3, :3] @ position + T[:3, 3]
    return frame


def _read_mimic(prim: "Usd.Prim") -> tuple[str, float, float] | None:
    """The joint that a joint follows, factor and offset (rad, m), as MuJoCo or PhysX state it."""
    target = prim.GetRelationship("mjc:target")
    if target and target.GetTargets():
        values = [prim.GetAttribute(f"mjc:coef{k}").Get() for k in (0, 1)]
        return (
            str(target.GetTargets()[0]),
            float(1.0 if values[1] is None else values[1]),
            float(values[0] or 0.0),
        )
    for said in prim.GetRelationships():
        found = PHYSX_MIMIC.fullmatch(said.GetName())
        if found is None or not said.GetTargets():
            continue
        leader = prim.GetStage().GetPrimAtPath(said.GetTargets()[0])
        own, other = ("Revolute" in (one.GetTypeName() if one else "") for one in (prim, leader))
        degree = np.pi / 180.0
        gearing, offset = (
            prim.GetAttribute(f"{found[1]}:{name}").Get() or 0.0 for name in ("gearing", "offset")
        )
        factor = -gearing * (degree if own else 1.0) / (degree if other else 1.0)
        return str(said.GetTargets()[0]), float(factor), float(-offset * (degree if own else 1.0))
    return None


def make_joint(edge: Edge, names: dict[str, str], path: Path, *, back: bool) -> UrdfJoint:
    """The joint with a coordinate that is 0 where the stage has it; parent, child and place are still open.

    Raises:
        SourceError: If the joint is neither fixed, revolute nor prismatic, or slides without limits.
    """
    joint = replace(weld(names[edge.path]), type=edge.type)
    if edge.type == "fixed":
        return joint
    if edge.type not in KINDS.values():
        allowed = ", ".join(KINDS)
        raise SourceError(f"{path}: joint {edge.path} is a {edge.type}, expected one of {allowed}")
    first, second = edge.T_world_joint
    between, sign = inverse(first) @ second, -1.0 if back else 1.0
    if edge.type == "prismatic":
        value = float(between[:3, 3] @ edge.axis)
    else:
        k = int(np.argmax(edge.axis))
        i, j = (k + 1) % 3, (k + 2) % 3
        value = float(np.arctan2(between[j, i] - between[i, j], between[i, i] + between[j, j]))
    lower, upper = (end - value for end in edge.limits)
    endless = not np.isfinite([lower, upper]).all()
    mimic = edge.mimic if edge.mimic is not None and edge.mimic[0] in names else None
    if edge.type == "prismatic" and endless and mimic is None:
        raise SourceError(
            f"{path}: joint {edge.path} slides without limits, expected physics:lowerLimit and upperLimit"
        )
    joint = replace(
        joint,
        type="continuous" if endless and edge.type == "revolute" else edge.type,
        axis=sign * first[:3, :3] @ edge.axis,
        lower=None if endless else lower,
        upper=None if endless else upper,
    )
    if mimic is None:
        return joint
    leader, factor, offset = mimic
    return replace(joint, mimic=names[leader], mimic_multiplier=factor, mimic_offset=offset)
