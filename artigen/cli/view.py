"""`artigen view`: a package in the browser."""

import sys
import time
from pathlib import Path

import tyro


def view(package: tyro.conf.Positional[Path], port: int = 8080) -> int:
    """Show a package in the browser: joint sliders, visual and collision meshes, Gaussians, handles.

    Args:
        package: Package folder.
        port: TCP port of the local server.
    """
    from sim_export.picture.view import view_package

    page = view_package(package, port=port)
    sys.stderr.write(f"{package}: http://localhost:{page.server.get_port()} (Ctrl-C ends it)\n")
    try:
        while True:
            time.sleep(3600.0)
    except KeyboardInterrupt:
        return 0
