"""Measures the holding force of SAPIEN's joint friction against a force-limited drive.

Prints the holding effort of horizontal drawers and doors as part of the load that they carry, for
several coefficients and time steps, and beside it that of `envs.sim.friction`, which is what was asked for.
"""

import tempfile
from pathlib import Path

import numpy as np
import tyro

from envs.sim.friction import apply_friction
from envs.sim.scene import create_scene

GRAVITY = 9.81
COEFFICIENTS = (0.01, 0.05, 0.2, 1.0)
HELD = 1e-3
"""Movement (m or rad) within a second that still counts as holding."""


def urdf(kind: str, mass: float, width: float) -> str:
    """A drawer, or a door hung at its edge, of a uniform box."""
    depth, height = (0.4, 0.15) if kind == "drawer" else (0.02, 0.7)
    center = 0.0 if kind == "drawer" else -width / 2
    ixx, iyy, izz = (
        mass / 12 * (a * a + b * b) for a, b in ((width, height), (depth, height), (depth, width))
    )
    motion = (
        '<joint name="j" type="prismatic">' if kind == "drawer" else '<joint name="j" type="revolute">'
    ) + f'<axis xyz="{"1 0 0" if kind == "drawer" else "0 0 1"}"/>'
    return f"""<robot name="r"><link name="base"/><link name="part">
      <inertial><origin xyz="0 {center} 0"/><mass value="{mass}"/>
        <inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial>
      <collision><origin xyz="0 {center} 0"/>
        <geometry><box size="{depth} {width} {height}"/></geometry></collision>
      </link>{motion}<parent link="base"/><child link="part"/>
      <limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>"""


def holding_effort(scene, articulation, most: float) -> float:
    """The smallest constant effort that moves the joint, by bisection."""
    low, high = 0.0, most
    for _ in range(16):
        middle = (low + high) / 2
        articulation.set_qpos(np.zeros(1, dtype=np.float32))
        articulation.set_qvel(np.zeros(1, dtype=np.float32))
        for _ in range(round(1.0 / scene.timestep)):
            articulation.set_qf(np.array([middle], dtype=np.float32))
            scene.step()
        low, high = (low, middle) if abs(articulation.qpos[0]) > HELD else (middle, high)
    return high


def main(iterations: int = 15) -> None:
    """Measures with ``iterations`` position iterations of the solver (ManiSkill uses 15)."""
    cases = [("drawer", mass, 0.7) for mass in (1.0, 5.0, 20.0)]
    cases += [("door", 5.0, width) for width in (0.3, 0.6, 1.2)]
    for kind, mass, width in cases:
        load = mass * GRAVITY * (1.0 if kind == "drawer" else width / 2)
        for frequency in (60, 100, 240):
            scene = create_scene(1.0 / frequency)
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "part.urdf"
                path.write_text(urdf(kind, mass, width))
                articulation = scene.create_urdf_loader().load(str(path))
            articulation.set_solver_position_iterations(iterations)
            joint = articulation.active_joints[0]
            held = []
            for coefficient in COEFFICIENTS:
                joint.set_friction(coefficient)
                held.append(holding_effort(scene, articulation, 5 * load) / load)
            apply_friction(joint, 0.1 * load)
            exact = holding_effort(scene, articulation, 5 * load) / load
            row = "  ".join(f"{mu:g}: {value:.4f}" for mu, value in zip(COEFFICIENTS, held, strict=True))
            print(f"{kind} {mass:g} kg {width:g} m {frequency} Hz  {row}  drive for 0.1: {exact:.4f}")


if __name__ == "__main__":
    tyro.cli(main)
