"""Physics scenes on the CPU, and detection of a render device."""

import functools
import subprocess
import sys
from typing import TYPE_CHECKING

from artigen.errors import ArtigenError

if TYPE_CHECKING:
    import sapien

PROBE = "import sapien; sapien.Scene([sapien.physx.PhysxCpuSystem(), sapien.render.RenderSystem()])"
DEFAULT_MATERIAL = (0.3, 0.3, 0.1)
"""SAPIEN's default static and dynamic friction and restitution of surfaces without a material."""


class NoRenderDevice(ArtigenError):
    """Rendering was requested on a machine without a usable Vulkan device."""


@functools.cache
def has_render_device() -> bool:
    """Whether SAPIEN can render here; tested in a child process, because it may abort instead of raising."""
    try:
        done = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, timeout=60.0)
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def reset_physx() -> None:
    """Resets the global PhysX settings to SAPIEN's defaults."""
    from sapien import physx

    physx.set_scene_config()
    physx.set_body_config()
    physx.set_shape_config()
    physx.set_default_material(*DEFAULT_MATERIAL)


def create_scene(timestep: float, *, ground: bool = False, render: bool = False) -> "sapien.Scene":
    """An empty scene with gravity (0, 0, -9.81) m/s^2.

    PhysX settings are global to the process, and ManiSkill changes them. SAPIEN's defaults are therefore
    restored, so that results do not depend on earlier code.

    Args:
        timestep: Seconds per step.
        ground: Adds the plane z = 0.
        render: Adds a render system and lights.

    Raises:
        NoRenderDevice: If ``render`` is requested and there is no device.
    """
    import sapien

    if not timestep > 0.0:
        raise ValueError(f"timestep {timestep} s, expected > 0")
    reset_physx()
    systems: list = [sapien.physx.PhysxCpuSystem()]
    if render:
        if not has_render_device():
            raise NoRenderDevice("SAPIEN finds no Vulkan device here; keep render_mode=None")
        systems.append(sapien.render.RenderSystem())
    scene = sapien.Scene(systems)
    scene.set_timestep(timestep)
    if ground:
        scene.add_ground(0.0, render=render)
    if render:
        scene.set_ambient_light([0.5, 0.5, 0.5])
        scene.add_directional_light([1.0, 0.5, -1.0], [1.5, 1.5, 1.5])
    return scene
