"""`artigen sets`: groups packages by topology."""

import json
import sys
from collections import defaultdict
from pathlib import Path

from artigen.cli.arguments import Packages


def sets(packages: Packages, json_file: Path | None = None, least: int = 1) -> int:
    """Group packages by topology: same links, joints and kinds of collision shapes, by name and order.

    Args:
        packages: Package folders, or folders that contain packages at any depth.
        json_file: Also write the groups to this file, as a mapping from topology to folders.
        least: Omit groups with fewer packages than this.
    """
    from sim_export.files.folders import find_packages
    from sim_export.files.read import read_package
    from sim_export.topology import find_topology

    found: dict[str, list[Path]] = defaultdict(list)
    what: dict[str, str] = {}
    for folder in find_packages(packages):
        package = read_package(folder, appearance=False)
        topology = find_topology(package)
        found[topology].append(folder)
        moving = sum(joint.type != "fixed" for joint in package.joints)
        hulls = sum(len(link.hulls) for link in package.links)
        what.setdefault(topology, f"{package.category}, {moving} joints, {hulls} collision shapes")
    ordered = sorted(found.items(), key=lambda item: (-len(item[1]), item[0]))
    kept = {topology: folders for topology, folders in ordered if len(folders) >= least}
    for topology, folders in kept.items():
        names = ", ".join(folder.name for folder in folders[:4]) + (" ..." if len(folders) > 4 else "")
        sys.stdout.write(f"{topology}  {len(folders):4d}  {what[topology]}: {names}\n")
    if json_file is not None:
        listed = {topology: [str(folder) for folder in folders] for topology, folders in kept.items()}
        json_file.write_text(json.dumps(listed, indent=1) + "\n")
    return 0
