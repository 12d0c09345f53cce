"""`artigen demo`: the whole way on an embedded object, with everything to look at afterwards."""

import sys
from pathlib import Path

from artigen.cli.arguments import Out


def demo(out: Out = Path("out/demo"), workers: int = 2) -> int:
    """Converts the embedded sample cabinet in both ways, proves the packages and draws them.

    Args:
        out: Folder for source, packages, reports and pictures.
        workers: Processes side by side.
    """
    from artigen.cli.convert import ConvertSettings, convert
    from artigen.datasets.sample import write_sample
    from sim_export.preview import write_preview

    source = out / "object" / "sample_cabinet"
    if not source.is_dir():
        write_sample(source)
    codes = []
    for visual in ("voxels", "source"):
        folder = out / visual
        codes.append(convert((source,), folder, ConvertSettings(visual=visual), workers=workers))
        write_preview((folder / source.name,), out / f"{visual}.png")
    sys.stdout.write(
        f"\nobject     {source}\n"
        f"packages   {out}/voxels/{source.name}  {out}/source/{source.name}\n"
        f"reports    validation.json in each package\n"
        f"pictures   {out}/voxels.png  {out}/source.png\n"
        f"look at it artigen view {out}/voxels/{source.name}\n"
    )
    return max(codes)
