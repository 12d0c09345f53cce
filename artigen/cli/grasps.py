"""`artigen grasps`: where parallel grippers hold packages."""

import sys
from pathlib import Path
from typing import Annotated, Literal

import tyro

from artigen.cli.arguments import Packages
from artigen.io import write_whole


def grasps(
    packages: Packages,
    gripper: tuple[str, ...] = ("franka",),
    engines: tuple[Literal["sapien", "mujoco"], ...] = ("sapien", "mujoco"),
    out: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None,
) -> int:
    """Find grasps of every handle, prove them in physics, and store them in annotations.json.

    A gripper closes on the handle and takes it along the path of its joint, in several strokes where it has
    no room for one; a grasp is proven if the joint has then come 90 % of the stroke and both fingers still
    touch. Exits with 1 if a handle has no proven grasp for a stroke.

    Args:
        packages: Package folders, or folders that contain packages at any depth.
        gripper: franka, robotiq_2f85, or parallel:WIDTH with a width in metres.
        engines: Engines that must prove a grasp.
        out: Also write all grasps as a table, grasps.csv, and those of each package as HDF5 in the layout of
            ACRONYM and as isaac_grasp YAML into this folder.
    """
    from artigen.api.grasps import add_grasps, export_grasps, store_grasps
    from sim_export.files.folders import find_packages
    from sim_export.files.grasp_formats import table_text
    from sim_export.files.read import read_package
    from sim_export.package import WHOLE

    missing, done = 0, []
    for folder in find_packages(packages):
        package = read_package(folder)
        for name in gripper:
            package, found = add_grasps(package, name, engines, folder)
            for each in found:
                proven = sum(grasp.proven for grasp in each.grasps)
                missing += proven == 0
                said = each.reason or f"{proven} of {len(each.grasps)} grasps proven"
                begin, end = each.stroke
                stroke = "" if (begin, end) == WHOLE else f" from {begin:.0%} to {end:.0%}"
                sys.stdout.write(f"{folder} {name} {each.target.part}{stroke}: {said}\n")
        store_grasps(package, folder)
        done.append(package)
        if out is not None:
            export_grasps(package, out)
    if out is not None:
        write_whole(out / "grasps.csv", table_text(done))
    return 1 if missing else 0
