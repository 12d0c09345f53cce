"""Procedural objects in code: ask for some, look at them, take their exact truth, write a package.

You will see the parts of a desk, the field that a network sees of it, and what the package holds.
"""

import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.sheet import draw_sheet
from artigen.voxels.fields import encode
from sim_export.files.write import write_package
from sim_export.reference import build_reference


def main(folder: Path) -> None:
    """Draws three desks and writes their picture and one package inside ``folder``."""
    # What is not asked for is drawn from the seed.
    desks = [draw_shape("Table", seed, Wish(width=1.4, counts=(("drawer", 3),))) for seed in range(3)]
    for desk in desks:
        assert dict(desk.condition.counts)["drawer"] == 3
        assert abs(desk.condition.width - 1.4) < 0.01
    sheet = np.concatenate([draw_sheet(desks, opened, 120, columns=3) for opened in (0.0, 1.0)])
    Image.fromarray(sheet).save(folder / "desks.png")

    asset = shape_to_asset(desks[0], spacing=0.01)
    for part in asset.parts:
        print(f"{part.name:12} {part.label:8} {part.joint.type}")
    print(f"what a network sees: {encode(asset).shape}")

    written = write_package(build_reference(desks[0]), folder / asset.name)
    assert (written / "mobility.urdf").is_file()
    print(f"{sum(path.is_file() for path in written.rglob('*'))} files in the package of {asset.name}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
