"""Builds the wheel, unpacks it elsewhere, and uses it from an empty folder.

The source tree is not on the path there, so whatever the wheel lacks is missed.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from sample_partnet import write_sample

ROOT = Path(__file__).resolve().parents[1]
CHECK = """
import sys
import artigen, sim_export, envs
for package in (artigen, sim_export, envs):
    assert package.__file__.startswith(sys.argv[1]), package.__file__
"""


def main() -> None:
    """Raises `subprocess.CalledProcessError` where a step fails."""
    with tempfile.TemporaryDirectory() as scratch:
        dist, site, work = (Path(scratch) / name for name in ("dist", "site", "work"))
        work.mkdir()
        write_sample(work / "sample_cabinet")
        python = sys.executable
        subprocess.run(
            [python, "-m", "build", "--wheel", "-o", dist, ROOT], check=True, stdout=subprocess.DEVNULL
        )
        (wheel,) = dist.glob("*.whl")
        subprocess.run(
            [python, "-m", "pip", "install", "-q", "--no-deps", "--target", site, wheel], check=True
        )
        environment = os.environ | {"PYTHONPATH": str(site)}
        for arguments in (
            ["-c", CHECK, str(site)],
            ["-m", "artigen", "convert", "sample_cabinet", "-o", "packages", "--workers", "1"],
        ):
            subprocess.run([python, *arguments], check=True, cwd=work, env=environment)
        urdf = work / "packages" / "sample_cabinet" / "mobility.urdf"
        print(f"{wheel.name}: works elsewhere, {urdf.name} of the sample has {urdf.stat().st_size} bytes")


if __name__ == "__main__":
    main()
