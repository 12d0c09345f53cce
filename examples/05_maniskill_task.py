"""A ManiSkill task on an object of one's own: a Panda opens its drawer, and the demonstration is kept.

You will see how far the drawer stands open in the end, and what is in the recorded file.
"""

import json
import tempfile
from pathlib import Path

import gymnasium as gym

from artigen.shapes.draw import Wish, draw_shape
from sim_export.files.write import write_package
from sim_export.reference import build_reference


def main(folder: Path) -> None:
    """Writes and proves a drawn cabinet in ``folder``; the scripted solver opens its drawer."""
    import envs  # noqa: F401  registers the tasks
    from envs.maniskill.solver.record import record_episodes
    from envs.maniskill.solver.solve import solve_open_part
    from envs.validate import validate

    wish = Wish(counts=(("drawer", 1), ("door", 1)))
    shape = draw_shape("StorageFurniture", 0, wish)
    report = validate(write_package(build_reference(shape), folder / "packages" / "cabinet"))
    print(f"validation passed: {report.passed}")
    env = gym.make(
        "ArtiGen-OpenPart-v1",
        packages=str(folder / "packages"),
        part="drawer",
        robot_uids="panda",
        obs_mode="state",
        control_mode="pd_joint_pos",
        sim_backend="physx_cpu",
        render_backend="none",
    )
    (outcome,) = record_episodes(env, solve_open_part, [0], folder / "demonstrations")
    print(f"success {outcome.success} after {outcome.steps} steps, open to {outcome.open_fraction:.2f}")
    recorded = json.loads((folder / "demonstrations" / "demonstrations.json").read_text())
    print(f"recorded {len(recorded['episodes'])} episode of {recorded['env_info']['env_id']}")
    assert outcome.success
    assert len(recorded["episodes"]) == 1


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
