"""Runs a package's URDF in PyBullet, which reads a joint's friction and damping but applies only the latter.

Friction is implemented as in SAPIEN: a motor at rest whose largest force is the friction. Bullet also damps
every body slightly, grows hulls by a margin of 1 mm, which fills the gap between two drawers, and lets a
light button rest 0.3 mm past its limit; all three are corrected.
"""

from importlib.metadata import version
from pathlib import Path

from harness import JointFacts, LinkFacts, joint_facts, run

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false

BREAKING = 1e-3
HARDNESS = 0.8
"""Share of a joint's error that is corrected per step; Bullet's default is 0.2."""


class Pybullet:
    """PyBullet's link ``-1`` is the root; other links have the index of their joint."""

    def __init__(self, plan: dict) -> None:
        import pybullet

        self.bullet, self.version = pybullet, version("pybullet")
        pybullet.connect(pybullet.DIRECT)
        pybullet.setTimeStep(plan["timestep"])
        if not plan.get("as_loaded"):
            pybullet.setPhysicsEngineParameter(contactBreakingThreshold=BREAKING, erp=HARDNESS)
        flags = (
            pybullet.URDF_USE_INERTIA_FROM_FILE
            | pybullet.URDF_USE_SELF_COLLISION
            | pybullet.URDF_USE_SELF_COLLISION_EXCLUDE_PARENT
        )
        file = str(Path(plan["folder"]) / "mobility.urdf")
        self.body = pybullet.loadURDF(file, useFixedBase=True, flags=flags)
        self.lost = {}
        if any(joint["mimic"] for joint in plan["joints"]):
            self.lost["mimic"] = "PyBullet leaves <mimic> out"
        self.index: dict[str, int] = {}
        self.link_index = {pybullet.getBodyInfo(self.body)[0].decode(): -1}
        self.unlimited = {joint["name"] for joint in plan["joints"] if joint["type"] == "continuous"}
        for joint in range(pybullet.getNumJoints(self.body)):
            info = pybullet.getJointInfo(self.body, joint)
            self.link_index[info[12].decode()] = joint
            if not plan.get("as_loaded"):
                pybullet.changeDynamics(self.body, joint, linearDamping=0.0, angularDamping=0.0)
            if info[2] == pybullet.JOINT_FIXED:
                continue
            self.index[info[1].decode()] = joint
            if not plan.get("as_loaded"):
                self._hold(joint, info[7])
        self.names = list(self.index)

    def _hold(self, joint: int, friction: float) -> None:
        mode = self.bullet.VELOCITY_CONTROL
        self.bullet.setJointMotorControl2(self.body, joint, mode, targetVelocity=0.0, force=friction)

    def links(self) -> dict[str, LinkFacts]:
        return {
            name: {
                # A fixed root has no mass in Bullet.
                "mass": None if link < 0 else self.bullet.getDynamicsInfo(self.body, link)[0],
                "shapes": len(self.bullet.getCollisionShapeData(self.body, link)),
            }
            for name, link in self.link_index.items()
        }

    def joints(self) -> dict[str, JointFacts]:
        facts: dict[str, JointFacts] = {}
        for name, joint in self.index.items():
            info = self.bullet.getJointInfo(self.body, joint)
            limits = None if name in self.unlimited else info[8:10]
            facts[name] = joint_facts(limits, friction=info[7], damping=info[6])
        return facts

    def reset(self, qpos: dict[str, float], gravity: float) -> None:
        self.bullet.setGravity(0.0, 0.0, -gravity)
        for name, joint in self.index.items():
            self.bullet.resetJointState(self.body, joint, qpos.get(name, 0.0), 0.0)

    def step(self, efforts: dict[str, float]) -> None:
        for name, effort in efforts.items():
            mode = self.bullet.TORQUE_CONTROL
            self.bullet.setJointMotorControl2(self.body, self.index[name], mode, force=effort)
        self.bullet.stepSimulation()

    def positions(self) -> dict[str, float]:
        states = self.bullet.getJointStates(self.body, list(self.index.values()))
        return {name: state[0] for name, state in zip(self.names, states, strict=True)}


if __name__ == "__main__":
    run(Pybullet)
