"""Groups packages that one simulation batch can hold."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, kw_only=True)
class TopologySet:
    """Packages with the same links, joints and kinds of collision shapes, by name and order."""

    topology: str
    what: str
    """Kind, and numbers of joints and collision shapes, of the first one."""
    folders: tuple[Path, ...]


def group_packages(folders: Sequence[Path], least: int = 1) -> list[TopologySet]:
    """The packages in folders, at any depth, by topology; the largest set first.

    Args:
        folders: Packages, or folders that contain some.
        least: Sets with fewer packages are left out.

    Raises:
        PackageError: If a folder holds no package, or one cannot be read.
    """
    from sim_export.files.folders import find_packages
    from sim_export.files.read import read_package
    from sim_export.topology import find_topology

    found: dict[str, list[Path]] = defaultdict(list)
    what: dict[str, str] = {}
    for folder in find_packages(folders):
        package = read_package(folder, appearance=False)
        topology = find_topology(package)
        found[topology].append(folder)
        moving = sum(joint.type != "fixed" for joint in package.joints)
        hulls = sum(len(link.hulls) for link in package.links)
        what.setdefault(topology, f"{package.category}, {moving} joints, {hulls} collision shapes")
    ordered = sorted(found.items(), key=lambda item: (-len(item[1]), item[0]))
    return [
        TopologySet(topology=topology, what=what[topology], folders=tuple(own))
        for topology, own in ordered
        if len(own) >= least
    ]
