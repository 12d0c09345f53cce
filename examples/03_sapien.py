"""A package in a SAPIEN scene of your own, with joint friction applied, drawer and door half open.

You will see the joint positions after two seconds under gravity. No renderer is needed.
"""

import tempfile
from pathlib import Path

from artigen.cli.convert import ConvertJob, convert_object
from artigen.datasets.sample_partnet import write_sample


def main(folder: Path) -> None:
    """Converts the embedded cabinet inside ``folder`` and lets it stand."""
    from envs.loaded import advance, set_open_fraction
    from envs.package import LoadConfig, load_package
    from envs.scene import create_scene

    source = folder / "source" / "sample_cabinet"
    write_sample(source)
    convert_object(ConvertJob(source=source, out=folder / "packages"))
    scene = create_scene(timestep=0.01)
    loaded = load_package(scene, folder / "packages" / "sample_cabinet", LoadConfig())
    before = set_open_fraction(loaded, (0.5, 0.5, 0.0, 0.0))  # drawer, door, lock, tray
    for _ in range(200):
        advance(loaded)
    after = loaded.articulation.get_qpos()
    for joint, was, now in zip(loaded.articulation.get_active_joints(), before, after, strict=True):
        print(f"{joint.name}: {was:.4f} -> {now:.4f}")
    assert abs(after - before).max() < 0.01


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
