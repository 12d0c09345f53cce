"""`artigen sets`: groups packages by topology."""

import json
import sys
from pathlib import Path

from artigen.api.sets import group_packages
from artigen.cli.arguments import Packages
from artigen.io import write_whole


def sets(packages: Packages, json_file: Path | None = None, least: int = 1) -> int:
    """Group packages by topology: same links, joints and kinds of collision shapes, by name and order.

    Args:
        packages: Package folders, or folders that contain packages at any depth.
        json_file: Also write the groups to this file, as a mapping from topology to folders.
        least: Omit groups with fewer packages than this.
    """
    groups = group_packages(packages, least)
    for group in groups:
        names = ", ".join(folder.name for folder in group.folders[:4]) + (" ..." * (len(group.folders) > 4))
        sys.stdout.write(f"{group.topology}  {len(group.folders):4d}  {group.what}: {names}\n")
    if json_file is not None:
        listed = {group.topology: [str(folder) for folder in group.folders] for group in groups}
        write_whole(json_file, json.dumps(listed, indent=1) + "\n")
    return 0
