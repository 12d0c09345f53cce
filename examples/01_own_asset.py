"""An asset of your own making: a box with a sliding lid, from points on its surface to a package.

You will see the package's links with their masses, and its files.
"""

import tempfile
from pathlib import Path

import numpy as np

from artigen.types import FIXED, Asset, Joint, Part, SurfaceSamples
from artigen.voxels.voxelize import voxelize
from sim_export.export import export_asset
from sim_export.files.write import write_package


def box_points(low: list[float], high: list[float], count: int, rng: np.random.Generator):
    """Uniform points on the faces of a box, and their normals."""
    low, high = np.array(low), np.array(high)
    points = rng.uniform(low, high, (6, count, 3))
    normals = np.zeros_like(points)
    for face in range(6):
        axis, side = divmod(face, 2)
        points[face, :, axis] = (low, high)[side][axis]
        normals[face, :, axis] = (-1.0, 1.0)[side]
    return points.reshape(-1, 3), normals.reshape(-1, 3)


def main(folder: Path) -> None:
    """Builds, exports and writes the box inside ``folder``."""
    rng = np.random.default_rng(0)
    walls = [
        ([-0.5, -0.3, -0.2], [0.5, 0.3, -0.17]),
        ([-0.5, -0.3, -0.2], [-0.47, 0.3, 0.15]),
        ([0.47, -0.3, -0.2], [0.5, 0.3, 0.15]),
        ([-0.5, -0.3, -0.2], [0.5, -0.27, 0.15]),
        ([-0.5, 0.27, -0.2], [0.5, 0.3, 0.15]),
    ]
    lid = ([-0.5, -0.3, 0.17], [0.5, 0.3, 0.2])
    chunks = [box_points(low, high, 20_000, rng) for low, high in (*walls, lid)]
    points, normals = (np.concatenate(column) for column in zip(*chunks, strict=True))
    part_ids = np.repeat([0] * len(walls) + [1], 6 * 20_000)
    colors = np.where(part_ids[:, None] == 0, [150, 110, 70], [60, 90, 140]).astype(np.uint8)
    slide = Joint(type="prismatic", axis=np.array([-1.0, 0.0, 0.0]), origin=np.zeros(3), upper=0.6)
    box = np.array([[0.0, 0.0, -0.025], [1.0, 0.6, 0.35]])
    lid_box = np.array([[0.0, 0.0, 0.185], [1.0, 0.6, 0.03]])
    surface = SurfaceSamples(points=points, normals=normals, colors=colors, part_ids=part_ids)
    asset = Asset(
        name="sliding_box",
        category="Box",
        scale=0.4,
        parts=(
            Part(name="body", label="base", parent=-1, joint=FIXED, box=box),
            Part(name="lid", label="door", parent=0, joint=slide, box=lid_box),
        ),
        voxels=voxelize(surface),
        surface=surface,
    )
    package = export_asset(asset).package
    written = write_package(package, folder / asset.name)
    for link in package.links:
        mass = link.inertial.mass if link.inertial else 0.0
        print(f"{link.name:8} {', '.join(link.parts):12} {mass:5.2f} kg, {len(link.hulls)} hulls")
    files = sorted(path.relative_to(written).as_posix() for path in written.rglob("*") if path.is_file())
    print("\n".join(files))
    assert "mobility.urdf" in files


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
