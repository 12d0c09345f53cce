"""`artigen view`: shows a package in the browser."""

import time
from pathlib import Path

import tyro


def view(package: tyro.conf.Positional[Path], port: int = 8080) -> int:
    """Show a package in the browser: joint sliders, visual and collision meshes, Gaussians, handles.

    Args:
        package: Package folder.
        port: TCP port of the local server.
    """
    from artigen.api.object import load

    load(package).show(port)
    try:
        while True:
            time.sleep(3600.0)
    except KeyboardInterrupt:
        return 0
