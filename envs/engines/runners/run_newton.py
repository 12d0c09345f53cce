"""Runs a package in Newton, from its URDF or MJCF, with the solver that steps MuJoCo on a CPU."""

from pathlib import Path

import numpy as np
from harness import JointFacts, LinkFacts, joint_facts, run

# pyright: reportMissingImports=false


class Newton:
    """Newton labels links and joints by paths; their names are the last components."""

    def __init__(self, plan: dict) -> None:
        import newton
        import warp

        warp.config.quiet = True
        self.newton, self.version, self.dt = newton, newton.__version__, plan["timestep"]
        builder = newton.ModelBuilder()
        folder = Path(plan["folder"])
        if plan["file"] == "urdf":
            builder.add_urdf(str(folder / "mobility.urdf"), floating=False, hide_visuals=True)
        else:
            builder.add_mjcf(str(folder / "mobility.mjcf.xml"), floating=False, parse_visuals=False)
        self.model = builder.finalize(device="cpu")
        self.solver = newton.solvers.SolverMuJoCo(self.model, use_mujoco_cpu=not plan.get("warp"))
        self.states = [self.model.state(), self.model.state()]
        self.control = self.model.control()
        self.bodies = {label.split("/")[-1]: index for index, label in enumerate(self.model.body_label)}
        starts = self.model.joint_qd_start.numpy()
        fixed = int(newton.JointType.FIXED)
        self.dofs = {
            label.split("/")[-1]: int(starts[index])
            for index, label in enumerate(self.model.joint_label)
            if int(self.model.joint_type.numpy()[index]) != fixed
        }
        self.lost: dict[str, str] = {}

    def links(self) -> dict[str, LinkFacts]:
        masses, owners = self.model.body_mass.numpy(), self.model.shape_body.numpy()
        collides = self.model.shape_flags.numpy() & int(self.newton.ShapeFlags.COLLIDE_SHAPES)
        return {
            name: {"mass": float(masses[body]), "shapes": int(((owners == body) & (collides != 0)).sum())}
            for name, body in self.bodies.items()
        }

    def joints(self) -> dict[str, JointFacts]:
        model = self.model
        arrays = (
            model.joint_limit_lower, model.joint_limit_upper, model.joint_friction, model.joint_damping,
        )  # fmt: skip
        values = [array.numpy() for array in arrays]
        facts: dict[str, JointFacts] = {}
        for name, dof in self.dofs.items():
            lower, upper, friction, damping = (float(array[dof]) for array in values)
            limited = lower > -1e6 and upper < 1e6
            facts[name] = joint_facts((lower, upper) if limited else None, friction, damping)
        return facts

    def reset(self, qpos: dict[str, float], gravity: float) -> None:
        self.model.set_gravity((0.0, 0.0, -gravity))
        self.solver.notify_model_changed(self.newton.ModelFlags.MODEL_PROPERTIES)
        values = np.zeros(len(self.dofs), dtype=np.float32)
        for name, dof in self.dofs.items():
            values[dof] = qpos.get(name, 0.0)
        state = self.states[0]
        state.joint_q.assign(values)
        state.joint_qd.zero_()
        self.newton.eval_fk(self.model, state.joint_q, state.joint_qd, state)

    def step(self, efforts: dict[str, float]) -> None:
        forces = np.zeros(len(self.dofs), dtype=np.float32)
        for name, effort in efforts.items():
            forces[self.dofs[name]] = effort
        self.control.joint_f.assign(forces)
        now, after = self.states
        now.clear_forces()
        self.solver.step(now, after, self.control, None, self.dt)
        self.states = [after, now]

    def positions(self) -> dict[str, float]:
        values = self.states[0].joint_q.numpy()
        return {name: float(values[dof]) for name, dof in self.dofs.items()}


if __name__ == "__main__":
    run(Newton)
