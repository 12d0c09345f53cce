"""Installs the wheel with each extra in an environment of its own, and does there what the extra is for.

    python benchmarks/extras.py /tmp/extras              # all; or name some

The wheel and what it requires are installed once. Each extra has a virtual environment that sees these
packages, but not those of other extras. Its job must fail before the extra is installed, with a message that
names it, and succeed after. Prints a row of docs/reports/engines.md for each. Not tried: `dev`, in which the
gate runs.
"""

import argparse
import os
import shutil
import subprocess
import sys
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

from sample_partnet import write_sample

ROOT = Path(__file__).resolve().parents[1]
RECIPE = "name: two\nobjects: [{category: Microwave, count: 2}]\noptions: {validation: none}\n"
XACRO = """<robot name="box" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="width" default="0.3"/>
<link name="body"><visual><geometry><box size="0.4 $(arg width) 0.4"/></geometry></visual></link>
<link name="door"><visual><origin xyz="-0.01 0.1 0"/>
<geometry><box size="0.02 0.2 0.4"/></geometry></visual></link>
<joint name="hinge" type="revolute"><parent link="body"/><child link="door"/><origin xyz="-0.2 -0.1 0"/>
<axis xyz="0 0 1"/><limit lower="0" upper="1.5" effort="1" velocity="1"/></joint></robot>
"""
RENDER = """
import artigen
picture = artigen.load("oven").render(light="catalogue")
assert picture.ndim == 3 and picture.std() > 10.0, picture.std()
"""
ENCODE = """
from contextlib import suppress
from pathlib import Path
import torch
from artigen.models.public_encoders import DinoConfig, load_dinov2
with suppress(ImportError):
    import encoder_files
    encoder_files.write_dinov2(Path("dino"))
features = load_dinov2(Path("dino"), DinoConfig(width=48, patch=4, edge=4))(torch.rand(1, 4, 32, 32))
assert features.shape[1] == 48, features.shape
"""
TRUNK = """
from pathlib import Path
from artigen.reader.network import ReaderConfig, ReaderNetwork
from artigen.train.reader import ReaderRunConfig, find_trunk, load_pretrained
load_pretrained(ReaderNetwork(ReaderConfig()).trunk, find_trunk(ReaderRunConfig(folder=Path("run"))))
"""
PREPARE = (
    "artigen shape Oven --name oven",
    "artigen shape StorageFurniture --counts drawer=3 door=0 --name drawers",
)
"""Commands that make what the jobs work on."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """What an extra is for: commands of artigen or code, and files that they must leave."""

    steps: tuple[str, ...]
    leaves: tuple[str, ...] = ()


JOBS = {
    "dataset": Job(
        steps=("artigen dataset recipe.yaml -o set --workers 1", "artigen dataset verify set"),
        leaves=("set/manifest.parquet",),
    ),
    "encoders": Job(steps=(ENCODE,)),
    "lerobot": Job(
        steps=("artigen demos ArtiGen-OpenPart-v1 drawers -n 1 --pictures none -o demos --workers 0",),
        leaves=("demos/lerobot/meta/info.json",),
    ),
    "mitsuba": Job(steps=(RENDER,)),
    "ray": Job(
        steps=("artigen shape Microwave -n 2 -o many --runner ray",),
        leaves=("many/Microwave_1/validation.json",),
    ),
    "reader": Job(steps=(TRUNK,)),
    "usd": Job(
        steps=("artigen usd oven -o usd", "artigen convert usd/oven/usd/oven.usd -o back --workers 0"),
        leaves=("back/oven/mobility.urdf",),
    ),
    "xacro": Job(
        steps=("artigen convert box.urdf.xacro --arguments width:=0.5 -o boxes --workers 0",),
        leaves=("boxes/box/mobility.urdf",),
    ),
}


def main() -> int:
    """Exit code: how many extras fail."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path, help="for environments; one that is there is used as it is")
    parser.add_argument("extras", nargs="*", default=list(JOBS))
    args = parser.parse_args()
    with (ROOT / "pyproject.toml").open("rb") as file:
        known = set(tomllib.load(file)["project"]["optional-dependencies"]) - {"dev"}
    if known != set(JOBS) or not set(args.extras) <= known:
        raise SystemExit(
            f"extras {sorted(known)}, jobs {sorted(JOBS)}, asked {args.extras}: expected the same"
        )
    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    if not (wheels := list(folder.glob("*.whl"))):
        subprocess.run([sys.executable, "-m", "build", "--wheel", "-o", folder, ROOT], check=True)
        wheels = list(folder.glob("*.whl"))
    base = make_environment(folder / "base", f"{wheels[0]}")
    site = next((folder / "base" / "lib").glob("*/site-packages"))
    made = prepare(base, folder / "made")
    failed = 0
    for name in args.extras:
        before = do(base, JOBS[name], made, folder / "work" / f"{name}-without")
        begin = time.monotonic()
        python = make_environment(folder / name, f"{wheels[0]}[{name}]", site)
        installed = time.monotonic()
        after = do(python, JOBS[name], made, folder / "work" / name)
        done = time.monotonic()
        without = "works" if not before else "named" if f"artigen[{name}]" in before else before
        failed += bool(after) or without != "named"
        verdict = after or "works"
        print(
            f"| `{name}` | {without} | {verdict} | {installed - begin:.0f} | {done - installed:.0f} |",
            flush=True,
        )
    return failed


def make_environment(folder: Path, requirement: str, parent: Path | None = None) -> Path:
    """The Python of an environment with a wheel, made if missing; it sees the packages of ``parent``."""
    python = folder / "bin" / "python"
    if (folder / "complete").is_file():
        return python
    subprocess.run([sys.executable, "-m", "venv", "--clear", folder], check=True)
    if parent is not None:
        own = next((folder / "lib").glob("*/site-packages"))
        (own / "parent.pth").write_text(f"import site; site.addsitedir({str(parent)!r})\n")
    constraints = ROOT / "constraints.txt"
    subprocess.run([python, "-m", "pip", "install", "-q", "-c", constraints, requirement], check=True)
    (folder / "complete").touch()
    return python


def prepare(python: Path, folder: Path) -> Path:
    """A folder with what the jobs work on."""
    if not (folder / "box.urdf.xacro").is_file():
        folder.mkdir(exist_ok=True)
        for command in PREPARE:
            words = ["-m", *command.split(), "-o", ".", "--workers", "0"]
            subprocess.run([python, *words], check=True, cwd=folder)
        write_sample(folder / "cabinet")
        (folder / "recipe.yaml").write_text(RECIPE)
        (folder / "box.urdf.xacro").write_text(XACRO)
    return folder


def do(python: Path, job: Job, made: Path, work: Path) -> str:
    """Does a job in a folder that is made anew; returns the end of what the first failed step said, or ""."""
    shutil.rmtree(work, ignore_errors=True)
    shutil.copytree(made, work)
    environment = os.environ | {"PYTHONPATH": str(ROOT / "tests"), "OMP_NUM_THREADS": "1"}
    for step in job.steps:
        words = ["-m", *step.split()] if step.startswith("artigen ") else ["-c", step]
        done = subprocess.run(
            [python, *words], cwd=work, env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            return (done.stdout + done.stderr).strip()[-600:] or f"exit code {done.returncode}"
    missing = [name for name in job.leaves if not (work / name).is_file()]
    return f"no {', '.join(missing)}" if missing else ""


if __name__ == "__main__":
    sys.exit(main())
