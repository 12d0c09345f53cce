"""A package in a SAPIEN scene of your own, with joint friction applied, drawer and door half open.

You will see the joint positions after two seconds under gravity. No renderer is needed.
"""

import tempfile
from pathlib import Path

from artigen.shapes.draw import Wish, draw_shape
from sim_export.files.write import write_package
from sim_export.reference import build_reference


def main(folder: Path) -> None:
    """Writes a drawn cabinet into ``folder`` and lets it stand."""
    from envs.sim.loaded import set_open_fraction
    from envs.sim.sapien import LoadConfig, load_package
    from envs.sim.scene import create_scene

    wish = Wish(counts=(("drawer", 1), ("door", 1), ("tray", 0), ("wheel", 0), ("knob", 0)))
    package = write_package(build_reference(draw_shape("StorageFurniture", 0, wish)), folder / "cabinet")
    scene = create_scene(timestep=0.01)
    loaded = load_package(scene, package, LoadConfig())
    before = set_open_fraction(loaded, 0.5)
    for _ in range(200):
        loaded.step()
    after = loaded.articulation.get_qpos()
    for joint, was, now in zip(loaded.articulation.get_active_joints(), before, after, strict=True):
        print(f"{joint.name}: {was:.4f} -> {now:.4f}")
    assert abs(after - before).max() < 0.01


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
