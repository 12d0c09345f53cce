"""Runs a package's URDF in SAPIEN, loaded with `envs.sim.sapien`; the only runner that needs this project."""

from pathlib import Path

import numpy as np
from harness import JointFacts, LinkFacts, joint_facts, run


class Sapien:
    """SAPIEN reorders joints, so they are accessed by name."""

    def __init__(self, plan: dict) -> None:
        import sapien

        from envs.sim.sapien import LoadConfig, load_package
        from envs.sim.scene import create_scene

        self.version = sapien.__version__
        resistance = "engine" if plan.get("as_loaded") else "package"
        cfg = LoadConfig(base="fixed", joint_resistance=resistance)
        self.loaded = load_package(create_scene(plan["timestep"]), Path(plan["folder"]), cfg)
        self.articulation = self.loaded.articulation
        self.names = [joint.name for joint in self.articulation.active_joints]
        self.lost: dict[str, str] = {}

    def links(self) -> dict[str, LinkFacts]:
        return {
            load.name: {"mass": load.engine_mass if load.mass is not None else None, "shapes": load.shapes}
            for load in self.loaded.links
        }

    def joints(self) -> dict[str, JointFacts]:
        facts: dict[str, JointFacts] = {}
        followers = {self.names[each.column] for each in self.loaded.mechanism.followers}
        for joint in self.articulation.active_joints:
            lower, upper = (float(value) for value in np.asarray(joint.limits).reshape(-1))
            limited = bool(np.isfinite([lower, upper]).all())
            # The drive implements friction, or the coupling of a follower; a tendon implements damping.
            rubs = joint.damping > 0.0 and joint.name not in followers
            facts[joint.name] = joint_facts(
                (lower, upper) if limited else None,
                friction=float(joint.force_limit) if rubs else None,
                damping=None,
            )
        return facts

    def reset(self, qpos: dict[str, float], gravity: float) -> None:
        for link in self.articulation.links:
            link.disable_gravity = gravity == 0.0
        values = np.array([qpos.get(name, 0.0) for name in self.names], dtype=np.float32)
        self.articulation.set_qpos(values)
        self.articulation.set_qvel(np.zeros_like(values))
        self.articulation.set_qf(np.zeros_like(values))

    def step(self, efforts: dict[str, float]) -> None:
        self.loaded.step(efforts)

    def positions(self) -> dict[str, float]:
        return self.loaded.positions()


if __name__ == "__main__":
    run(Sapien)
