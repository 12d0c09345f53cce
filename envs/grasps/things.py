"""Grasps of the loose things of rooms: cups, pans, books, lifted by 20 cm from where they stand."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from jaxtyping import Float

from artigen.types import Joint
from sim_export.geometry.hulls import hull_volume
from sim_export.grasps.find import find_grasps
from sim_export.grasps.gripper import find_gripper
from sim_export.package import Grasp, Link, Mesh, SimPackage, Visual
from sim_export.physics.inertia import combine, mesh_inertial

from ..rooms.room import Item
from ..rooms.things import thing_hulls
from ..sim.load import EngineName
from .prove import prove_grasps


def grasp_thing(
    item: Item, gripper: str = "franka", engines: Sequence[EngineName] = ("sapien", "mujoco")
) -> tuple[Grasp, ...]:
    """Grasps of a thing that stands alone on a level place, those first that were proven.

    The gripper closes on it and lifts it by 20 cm; proven is what then hangs between both fingers at 90 % of
    the height. Things around it, and what holds it, are not seen. Their ``pose`` is in the frame of the
    thing, which ``position`` and ``quat`` of the item place in its holder.

    Args:
        item: A thing of a room.
        gripper: franka, robotiq_2f85, or ``parallel:WIDTH`` with a width in metres.
        engines: Engines that must prove a grasp.

    Raises:
        PackageError: If there is no such gripper.
    """
    return _grasp(item.thing, item.size, item.mass, gripper, tuple(engines))


@lru_cache(maxsize=1024)
def _grasp(
    thing: str, size: tuple[float, float, float], mass: float, gripper: str, engines: tuple[EngineName, ...]
) -> tuple[Grasp, ...]:
    package, hand = thing_package(thing, size, mass), find_gripper(gripper)
    found = prove_grasps(package, find_grasps(package, hand), hand, engines)
    return tuple(grasp for each in found for grasp in each.grasps)


def thing_package(thing: str, size: tuple[float, float, float], mass: float) -> SimPackage:
    """A thing as a package: one link, with its mass (kg) spread over its hulls by volume.

    Raises:
        ValueError: If there is no such thing.
    """
    hulls = thing_hulls(thing, size)
    density = mass / sum(hull_volume(hull) for hull in hulls)
    visuals = tuple(
        Visual(
            name=f"base_thing_{k}",
            part=thing,
            label="base",
            mesh=Mesh(vertices=hull.vertices, faces=hull.faces),
        )
        for k, hull in enumerate(hulls)
    )
    inertial = combine([mesh_inertial(hull, density) for hull in hulls])
    body = Link(name="thing", label="base", parts=(thing,), visuals=visuals, hulls=hulls, inertial=inertial)
    up: Float[np.ndarray, "3"] = np.array([0.0, 0.0, 1.0])
    fixed = Joint(name="joint_thing", type="fixed", axis=up, parent="base", child="thing")
    return SimPackage(
        name=thing, category="Thing", visual="exact", links=(Link(name="base"), body), joints=(fixed,)
    )
