"""Runs a package in MuJoCo: its MJCF, or its URDF if the plan says so."""

from pathlib import Path

from harness import JointFacts, LinkFacts, joint_facts, run

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false


class Mujoco:
    """MuJoCo fixes bodies without a joint to the world."""

    def __init__(self, plan: dict) -> None:
        import mujoco

        self.mujoco, self.version = mujoco, mujoco.__version__
        name = "mobility.urdf" if plan["file"] == "urdf" else "mobility.mjcf.xml"
        mujoco.set_mju_user_warning(lambda _: None)
        self.model = mujoco.MjModel.from_xml_path(str(Path(plan["folder"]) / name))
        self.model.opt.timestep = plan["timestep"]
        if plan["file"] == "urdf" and not plan.get("as_loaded"):
            # A URDF cannot state the stiffness of limits and friction; the MJCF states it for each joint.
            self.model.jnt_solref[:, 0] = 0.004
            self.model.jnt_solimp[:, :3] = (0.99, 0.999, 0.0001)
            self.model.dof_solimp[:, :3] = (0.999, 0.9999, 0.0001)
        self.data = mujoco.MjData(self.model)
        bodies = {self.model.body(index).name: index for index in range(1, self.model.nbody)}
        self.lost = {}
        if plan["root"] not in bodies:
            self.lost["root"] = "the root link is part of the world and has no mass"
            bodies[plan["root"]] = 0
        self.bodies = {link["name"]: bodies[link["name"]] for link in plan["links"] if link["name"] in bodies}
        if plan["file"] == "urdf" and any(joint["mimic"] for joint in plan["joints"]) and not self.model.neq:
            self.lost["mimic"] = "MuJoCo leaves <mimic> out"
        self.names = [self.model.joint(index).name for index in range(self.model.njnt)]

    def links(self) -> dict[str, LinkFacts]:
        count = [0] * self.model.nbody
        for geom in range(self.model.ngeom):
            if self.model.geom_contype[geom] or self.model.geom_conaffinity[geom]:
                count[int(self.model.geom_bodyid[geom])] += 1
        return {
            name: {"mass": float(self.model.body_mass[body]) if body else None, "shapes": count[body]}
            for name, body in self.bodies.items()
        }

    def joints(self) -> dict[str, JointFacts]:
        facts: dict[str, JointFacts] = {}
        for index, name in enumerate(self.names):
            joint, dof = self.model.joint(index), self.model.jnt_dofadr[index]
            lower, upper = map(float, joint.range)
            facts[name] = joint_facts(
                (lower, upper) if joint.limited[0] else None,
                friction=float(self.model.dof_frictionloss[dof]),
                damping=float(self.model.dof_damping[dof].flat[0]),
            )
        return facts

    def reset(self, qpos: dict[str, float], gravity: float) -> None:
        self.mujoco.mj_resetData(self.model, self.data)
        self.model.opt.gravity[:] = (0.0, 0.0, -gravity)
        self.data.qpos[:] = [qpos.get(name, 0.0) for name in self.names]
        self.mujoco.mj_forward(self.model, self.data)

    def step(self, efforts: dict[str, float]) -> None:
        self.data.qfrc_applied[:] = [efforts.get(name, 0.0) for name in self.names]
        self.mujoco.mj_step(self.model, self.data)

    def positions(self) -> dict[str, float]:
        return dict(zip(self.names, self.data.qpos.tolist(), strict=True))


if __name__ == "__main__":
    run(Mujoco)
