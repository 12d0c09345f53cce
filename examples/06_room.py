"""A furnished room from packages: arranged, checked, opened, written, and stepped in SAPIEN.

You will see what stands in a bedroom, that every door and drawer of it has room to open, and that
nothing moves when gravity comes on.
"""

import tempfile
from pathlib import Path

import artigen
from artigen.api.scene import SceneSettings, furnish_room

OBJECTS = (
    ("StorageFurniture", 0.45, 0.4, 0.55),
    ("StorageFurniture", 1.0, 0.58, 2.0),
    ("StorageFurniture", 1.0, 0.48, 0.9),
    ("StorageFurniture", 1.4, 0.42, 0.5),
    ("StorageFurniture", 0.42, 0.5, 0.6),
    ("Table", 1.3, 0.65, 0.74),
)
"""Kind, width, depth and height (m)."""


def main(folder: Path) -> None:
    """Draws objects, furnishes a bedroom with them inside ``folder``, and lets it stand for a second."""
    import sapien

    from envs.rooms.check import check_room
    from envs.rooms.file import read_room
    from envs.sim.sapien import LoadConfig, load_package
    from envs.sim.scene import create_scene

    for seed, (kind, width, depth, height) in enumerate(OBJECTS):
        drawn = artigen.sample(kind, seed, width=width, depth=depth, height=height)
        report = drawn.export(folder / "packages" / drawn.name).validate()
        print(f"{drawn!r} {'passed' if report.passed else 'failed'}")
    cfg = SceneSettings(width=5.0, depth=4.6, ajar=0.3)
    print(furnish_room("bedroom", folder / "room", 1, folder / "packages", cfg, pictures="plan").describe())

    room = read_room(folder / "room")
    for placement in room.placements:
        opened = ", ".join(f"{name} at {q:.2f}" for name, q in placement.joints)
        print(f"{placement.id:14} {placement.package.name:20} {opened}")
    problems = [problem for problem in check_room(room) if problem.kind in ("overlap", "outside")]
    assert not problems, problems

    world = create_scene(timestep=0.01, ground=True)
    bodies = []
    for placement in room.placements:
        loaded = load_package(world, placement.package, LoadConfig())
        loaded.articulation.set_root_pose(sapien.Pose(p=list(placement.position), q=list(placement.quat)))
        bodies.append(loaded)
    before = [loaded.articulation.get_qpos().copy() for loaded in bodies]
    for _ in range(100):
        world.step()
    moved = max(
        abs(loaded.articulation.get_qpos() - was).max(initial=0.0)
        for loaded, was in zip(bodies, before, strict=True)
    )
    print(f"{len(bodies)} objects, the farthest joint moved {moved:.6f} (m or rad) in a second")
    assert moved < 0.005


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
