"""Counts USD assets that NVIDIA's SimReady validator accepts, and their missing features.

Usage: python benchmarks/usd_validate.py FOLDER [--profile Robotics-Prop] [--version 5.0.0]
FOLDER is what `artigen usd -o` wrote. The validator has its own USD: it is installed in an environment of
its own (pip install simready-validate simready-foundation-tier-core) and found by SIMREADY_VALIDATE or PATH.

No validator on PyPI knows Robotics-Prop 5.0.0 yet. Its static requirements are those of 4.0.0, AF.001 (where
the front is) and VM.MAT.001 (every drawn mesh has a material). For 5.0.0 the validator checks 4.0.0 and
`find_faults` the other two, after https://nvidia.github.io/simready-foundation/2026.10.0/.
"""

# usd-core has no type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

FORWARD = "simready:assetFrame:forwardDirection"
UNIT = 1e-4
"""Tolerance of the length of a direction."""
NEWEST, KNOWN = ("Robotics-Prop", "5.0.0"), "4.0.0"
"""The newest profile, and the version of it that the validator knows."""


def find_validator() -> str:
    """The executable; exits with a sentence where there is none."""
    found = os.environ.get("SIMREADY_VALIDATE") or shutil.which("simready-validate")
    if found is None:
        sys.exit("no simready-validate on PATH or in SIMREADY_VALIDATE; see the head of this file")
    return found


def validate(assets: list[Path], profile: str, version: str) -> str:
    """The validator's report over all assets."""
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as listed:
        listed.write("".join(f"{asset.resolve()}\n" for asset in assets))
        listed.flush()
        command = [find_validator(), "--profile", profile, "--version", version, "-v"]
        command += ["--asset_list", listed.name]
        return subprocess.run(command, capture_output=True, text=True, check=False).stdout


def find_faults(asset: Path) -> list[str]:
    """What an asset lacks of AF.001 and VM.MAT.001, one sentence each."""
    from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade

    stage = Usd.Stage.Open(str(asset))
    root, faults = stage.GetDefaultPrim(), list[str]()
    for prim in stage.Traverse():
        said = prim.GetAttribute(FORWARD)
        if not said or not said.IsAuthored():
            if prim == root:
                faults.append(f"AF.001 {prim.GetPath()}: no {FORWARD}")
        elif (
            said.GetTypeName() != Sdf.ValueTypeNames.Vector3f
            or said.GetVariability() != Sdf.VariabilityUniform
            or not said.IsCustom()
            or not said.HasAuthoredValue()
            or said.GetNumTimeSamples()
            or said.HasAuthoredConnections()
            or not prim.IsA(UsdGeom.Xformable)
            or not abs(Gf.Vec3d(said.Get()).GetLength() - 1.0) <= UNIT
        ):
            faults.append(f"AF.001 {prim.GetPath()}: {said.Get()} is no custom uniform unit vector3f")
        if prim.IsA(UsdGeom.Gprim) and UsdGeom.Imageable(prim).ComputePurpose() != UsdGeom.Tokens.guide:
            subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()
            for each in [subset.GetPrim() for subset in subsets] or [prim]:
                if not UsdShade.MaterialBindingAPI(each).ComputeBoundMaterial()[0]:
                    faults.append(f"VM.MAT.001 {each.GetPath()}: no material")
    return faults


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--profile", default="Robotics-Prop")
    parser.add_argument("--version", default="5.0.0")
    args = parser.parse_args()
    assets = sorted(args.folder.glob("*/usd/*.usd"))
    if not assets:
        sys.exit(f"{args.folder}: no asset in it (looked for */usd/*.usd); write some with `artigen usd`")
    newest = (args.profile, args.version) == NEWEST
    report = validate(assets, args.profile, KNOWN if newest else args.version)
    verdicts = re.findall(r"^Asset: .*?(\w+)/usd/\S+\n\s+\[(\w+)\]", report, re.MULTILINE)
    if newest:
        faults = {asset.stem: find_faults(asset) for asset in assets}
        verdicts = [(name, "; ".join(faults[name]) or verdict) for name, verdict in verdicts]
    passed = sum(verdict == "PASSED" for _, verdict in verdicts)
    print(f"| {args.profile} {args.version} | {passed} of {len(assets)} pass |\n|---|---|")
    for name, verdict in verdicts:
        if verdict != "PASSED":
            print(f"| {name} | {verdict} |")
    lacks = re.findall(r"(\w+): optional feature, unmet requirements: (\[.*?\])", report)
    for (feature, requirements), count in sorted(Counter(lacks).items()):
        print(f"| optional {feature} lacks {requirements} | {count} |")
    sys.exit(0 if passed == len(assets) else 1)


if __name__ == "__main__":
    main()
