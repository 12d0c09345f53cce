"""Trials of grasps in MuJoCo."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from artigen.transforms import quat_from_matrix
from sim_export.errors import PackageError
from sim_export.grasps.gripper import Gripper, mirrored
from sim_export.grasps.pairs import FRICTION
from sim_export.package import Proof, SimPackage

from ..limits import rest_coordinate
from ..sim.mechanism import find_mechanism
from .rail import (
    ARMATURE,
    FINGER_GAINS,
    FINGER_MASS,
    LOOK,
    PALM_MASS,
    RAIL_GAINS,
    Rail,
)

if TYPE_CHECKING:
    from mujoco import MjSpec

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false

TIMESTEP = 0.002
FINGERS = ("finger_left", "finger_right")
HAND = ("turn", "slide", *FINGERS)
"""Joints of the gripper, and its actuators."""
VISUAL = 2
"""Group of visual geoms."""


class MujocoTrials:
    """A package and a gripper in one model, in which the gripper tries grasps one after the other."""

    engine = "mujoco"

    def __init__(self, folder: Path, package: SimPackage, gripper: Gripper, *, loose: bool) -> None:
        import mujoco

        self.package = package
        self.names = tuple(joint.name for joint in package.joints if joint.type != "fixed")
        self.mechanism = find_mechanism(package, self.names)
        path = folder / "mobility.mjcf.xml"
        try:
            spec = mujoco.MjSpec.from_file(str(path))
            _without_visuals(spec)
            if loose:
                _set_free(spec, package)
            _add_hand(spec, gripper)
            self.model = spec.compile()
        except ValueError as error:
            text = " ".join(str(error).split())
            raise PackageError(f"{path}: MuJoCo cannot compile it with a gripper: {text}") from error
        self.data = mujoco.MjData(self.model)
        low = min(hull.vertices[:, 2].min() for link in package.links for hull in link.hulls)
        self.height = -low if loose else 0.0

    def prove(self, rail: Rail) -> Proof:
        """Closes the fingers, carries the gripper along its rail, and measures what came with it."""
        import mujoco

        model, data = self.model, self.data
        self._place(rail)
        columns = [model.joint(name).qposadr[0] for name in HAND]
        efforts = [model.joint(name).dofadr[0] for name in FINGERS]
        touched: set[str] = set()
        steps = round(rail.seconds / TIMESTEP)
        for step in range(steps):
            share = rail.share(step * TIMESTEP)
            data.qfrc_applied[efforts] = rail.press(step * TIMESTEP)
            middle = float(data.qpos[columns[2:]].mean())
            data.ctrl[:] = share * rail.turn, share * rail.slide, middle, middle
            mujoco.mj_step(model, data)
            if (steps - step) * TIMESTEP <= LOOK:
                touched |= self._touching(rail.link)
        return Proof(engine=self.engine, opened=self._opened(rail), held=touched >= set(FINGERS))

    def _place(self, rail: Rail) -> None:
        """The object as the trial begins, with the gripper open at its start."""
        import mujoco

        model, data = self.model, self.data
        offset = np.array([0.0, 0.0, self.height])
        for name in HAND[:2]:
            joint = model.joint(name)
            joint.axis[:], joint.pos[:] = rail.axis, rail.origin + offset
        palm = model.body("palm")
        palm.pos[:], palm.quat[:] = rail.start[:3, 3] + offset, quat_from_matrix(rail.start[:3, :3])
        mujoco.mj_setConst(model, data)
        mujoco.mj_resetData(model, data)
        specs = {joint.name: joint for joint in self.package.joints}
        q = {name: rest_coordinate(specs[name]) for name in self.names} | rail.needs
        whole = self.mechanism.complete(np.array([q[name] for name in self.names]))
        for name, value in zip(self.names, whole, strict=True):
            data.joint(name).qpos[:] = value
        if not rail.joint:
            data.qpos[model.joint("loose").qposadr[0] + 2] = self.height
        for name in FINGERS:
            data.joint(name).qpos[:] = rail.gap / 2.0
        mujoco.mj_forward(model, data)

    def _opened(self, rail: Rail) -> float:
        if rail.joint:
            return (float(self.data.joint(rail.joint).qpos[0]) - rail.lower) / rail.span
        body = self.data.body(rail.link)
        at = body.xmat.reshape(3, 3) @ rail.point + body.xpos
        return float(at[2] - rail.start[2, 3] - self.height) / rail.span

    def _touching(self, link: str) -> set[str]:
        """Fingers in contact with a link."""
        model = self.model
        pairs = model.geom_bodyid[self.data.contact.geom]
        names = [{model.body(int(one)).name, model.body(int(other)).name} for one, other in pairs]
        return {finger for pair in names if link in pair for finger in FINGERS if finger in pair}


def _without_visuals(spec: "MjSpec") -> None:
    """Deletes what only pictures need, which takes most of the time to compile."""
    for geom in list(spec.geoms):
        if geom.group == VISUAL:
            spec.delete(geom)
    used = {geom.meshname for geom in spec.geoms}
    for unused in [mesh for mesh in spec.meshes if mesh.name not in used] + list(spec.materials):
        spec.delete(unused)
    for texture in list(spec.textures):
        spec.delete(texture)


def _set_free(spec: "MjSpec", package: SimPackage) -> None:
    """Lets the object stand on a floor."""
    import mujoco

    spec.body(package.links[0].name).add_joint(name="loose", type=mujoco.mjtJoint.mjJNT_FREE)
    spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[5.0, 5.0, 0.1])


def _add_hand(spec: "MjSpec", gripper: Gripper) -> None:
    """Adds the gripper and its rail."""
    import mujoco

    spec.option.timestep = TIMESTEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10.0  # as MuJoCo Menagerie sets for grippers: pads creep less
    rail = spec.worldbody.add_body(name="rail", gravcomp=1.0)
    for name, kind in zip(HAND, (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE), strict=False):
        rail.add_joint(name=name, type=kind, axis=[0.0, 0.0, 1.0], armature=ARMATURE)
    palm = rail.add_body(name="palm", gravcomp=1.0)
    _add_boxes(palm, gripper.palm, PALM_MASS)
    sides = ((1.0, gripper.finger), (-1.0, mirrored(gripper.finger)))
    for name, (side, boxes) in zip(FINGERS, sides, strict=True):
        finger = palm.add_body(name=name, gravcomp=1.0)
        finger.add_joint(
            name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, side, 0.0],
            range=[0.0, gripper.opening / 2.0], limited=1,
        )  # fmt: skip
        _add_boxes(finger, boxes, FINGER_MASS)
    for name in HAND:
        stiffness, damping = FINGER_GAINS if name in FINGERS else RAIL_GAINS
        drive = spec.add_actuator(name=name, trntype=mujoco.mjtTrn.mjTRN_JOINT, target=name)
        drive.set_to_position(kp=stiffness, kv=damping)


def _add_boxes(body: object, boxes: np.ndarray, mass: float) -> None:
    """Boxes of one body with a mass between them. Their friction and stiffness count in every contact: with
    MuJoCo's default, pads that close on a thin lip sink in until they are pushed off it."""
    import mujoco

    for low, high in boxes:
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX, pos=(low + high) / 2.0, size=(high - low) / 2.0,
            mass=mass / len(boxes), friction=[FRICTION, 0.005, 0.0001], priority=1,
            solref=[2.0 * TIMESTEP, 1.0], solimp=[0.95, 0.99, 0.001, 0.5, 2.0],
        )  # fmt: skip
