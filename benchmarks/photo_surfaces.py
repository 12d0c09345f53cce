"""Renderings of real objects to objects: how far apart are their surfaces, closed and opened?

    python benchmarks/photo_surfaces.py FOLDER --half 0

The folder holds PartNet-Mobility objects by id in ``partnet_mobility`` and ``splits.json``. Every object of
the seven categories is rendered from near its front, before plain grey, read and built as by ``artigen
generate --image``, and compared with the real one: squared Chamfer distance (both directions added) of points
spread evenly on all surfaces, each object in its own unit cube (longest edge 1 when closed): closed; as mean
of `STATES` of the published protocol, which opens every hinge to 90 degrees and every slide to its end
(`artigen.metrics.compat`); and with all joints at their upper limits. To tell causes apart, the same is
measured with the true kind said, with the true lengths as well, and with the true fronts, hinges and view
instead of those that were read."""

import json
import time
import zlib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import tyro
from jaxtyping import Float
from PIL import Image

from artigen.camera import Camera, frame_points, project_points
from artigen.datasets.partnet_mobility import read_object
from artigen.datasets.partnet_surface import join_tables
from artigen.datasets.source_object import ReaderConfig, SourceObject
from artigen.errors import ArtigenError
from artigen.examples.mesh_pictures import FINE, picture_mesh
from artigen.examples.photographs import NEAR_FRONT, find_direction
from artigen.kind import paper_kinds
from artigen.kinematics import articulate_points, movable_parts, qlimits
from artigen.metrics.clouds import chamfer
from artigen.metrics.compat import STATES
from artigen.reader.correct import Side, correct_reading
from artigen.reader.layout.build import build_from_reading
from artigen.reader.layout.frontal import READ
from artigen.reader.looks import look_closer
from artigen.reader.model import load_reader
from artigen.reader.read import read_image
from artigen.reader.reading import Reading, ReadPart
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import Wish
from artigen.shapes.poses import open_parts
from artigen.shapes.shape import Shape
from artigen.shapes.sheet import draw_picture
from artigen.types import Asset, Part
from artigen.weights import READER

EDGE, GREY = 384, 205
"""Edge of a rendering (pixels) and the value behind the object."""
POINTS = 20_000
"""Points on each object."""
SPACING = 0.008
"""Mean distance (unit-cube lengths) of the points that these are taken of."""
WAYS = ("read", "kind", "lengths", "fronts")
"""What is known: nothing but the picture; the kind; the lengths, too; the fronts and the view, too."""


def photograph(source: SourceObject, seed: int) -> tuple[Image.Image, Camera, tuple[float, float]]:
    """A rendering, its camera at one ray per pixel, and its yaw and pitch (radians)."""
    vertices, faces = join_tables(source.tables)
    points = source.asset.scale * vertices[np.unique(faces)]
    rng = np.random.default_rng([seed, 1])
    turn, lift = rng.uniform(-NEAR_FRONT[0], NEAR_FRONT[0]), rng.uniform(0.0, NEAR_FRONT[1])
    fine, camera = (
        frame_points(points, find_direction(turn, lift), width=size, height=size)
        for size in (FINE * EDGE, EDGE)
    )
    rgba = picture_mesh(source.tables, source.asset.scale, fine).astype(np.float64)
    shown = rgba[..., :3] + (1.0 - rgba[..., 3:] / 255.0) * GREY
    image = Image.fromarray(np.clip(np.rint(shown), 0, 255).astype(np.uint8)).convert("RGBA")
    return image, camera, (float(turn), float(lift))


def mark(asset: Asset, camera: Camera, view: tuple[float, float], seen: Reading) -> Reading:
    """What a reader without error would say of a real object, with the looks that were read."""
    parts: list[ReadPart] = []
    for part in asset.parts:
        label = READ.get(part.label)
        if label is None or (part.joint.type == "fixed" and label != "handle"):
            continue
        (x0, y0, z0), (x1, y1, z1) = part.box[0] - part.box[1] / 2, part.box[0] + part.box[1] / 2
        face = np.array([(x0, y1, z1), (x0, y0, z1), (x0, y0, z0), (x0, y1, z0)])
        if part.box[1].argmin() == 2:
            face = np.array([(x1, y1, z1), (x1, y0, z1), (x0, y0, z0), (x0, y1, z0)])
        corners = project_points(camera, asset.scale * face)[:, :2] / EDGE
        parts.append(
            ReadPart(
                label=label,
                score=1.0,
                box=np.concatenate([corners.min(axis=0), corners.max(axis=0)]),
                corners=corners if label in ("door", "drawer") else None,
                hinge=_find_hinge(part) if label == "door" else None,
                form="bar" if label == "handle" else None,
            )
        )
    fronts = [part for part in parts if part.label in ("door", "drawer")]
    low, high = _bound(asset)
    outline = np.stack(np.meshgrid(*np.stack([low, high]).T), axis=-1).reshape(-1, 3)
    around = project_points(camera, outline)[:, :2] / EDGE
    depth, width, height = high - low
    return replace(
        seen,
        parts=(*fronts, *(part for part in parts if part.label not in ("door", "drawer"))),
        box=np.concatenate([around.min(axis=0), around.max(axis=0)]),
        size=(width, depth, height),
        view=(*view, seen.view[2]),
    )


def _bound(asset: Asset) -> Float[np.ndarray, "2 3"]:
    """Least and greatest corner (m) of a closed object."""
    boxes = np.stack([part.box for part in asset.parts]) * asset.scale
    return np.stack(
        [(boxes[:, 0] - boxes[:, 1] / 2).min(axis=0), (boxes[:, 0] + boxes[:, 1] / 2).max(axis=0)]
    )


def _find_hinge(part: Part) -> Side | None:
    if part.joint.type == "prismatic":
        return None
    out = np.asarray(part.joint.origin) - part.box[0]
    if abs(part.joint.axis[2]) > 0.7:
        return "left" if out[1] > 0 else "right"
    return "bottom" if out[2] < 0 else "top"


def build(reading: Reading, asset: Asset, way: str, view: tuple[float, float], camera: Camera) -> Shape:
    """The object with as much of the truth as a way knows."""
    wish = Wish()
    if way != "read" and reading.kind != asset.category:
        reading = correct_reading(reading, kind=asset.category)
    if way in ("lengths", "fronts"):
        depth, width, height = np.ptp(_bound(asset), axis=0)
        wish = Wish(width=float(width), depth=float(depth), height=float(height))
    if way == "fronts":
        reading = mark(asset, camera, view, reading)
    return build_from_reading(reading, 0, wish)[0]


MEASURED = ("closed", "five states", "at the limits")


def measure(found: Asset, truth: Asset) -> tuple[float, ...]:
    """Squared Chamfer distance of all surfaces in each way of `MEASURED`."""
    clouds = []
    for asset in (found, truth):
        assert asset.surface is not None
        held = asset.surface
        rows = np.random.default_rng(0).choice(len(held.points), POINTS, replace=len(held.points) < POINTS)
        points, parts = held.points[rows].astype(np.float64), held.part_ids[rows].astype(np.int64)
        poses = [share * open_alike(asset) for share in STATES] + [qlimits(asset)[:, 1]]
        clouds.append([articulate_points(asset, pose, points, parts) for pose in poses])
    distances = [chamfer(one, other) for one, other in zip(*clouds, strict=True)]
    return distances[0], float(np.mean(distances[:-1])), distances[-1]


def open_alike(asset: Asset) -> Float[np.ndarray, "J"]:
    """Joints as the published protocol opens them fully: hinges by 90 degrees whatever their range."""
    joints = [asset.parts[part].joint for part in movable_parts(asset)]
    return np.array([np.pi / 2 if joint.type == "revolute" else joint.upper for joint in joints])


def main(
    folder: tyro.conf.Positional[Path],
    *,
    half: int = 0,
    count: int | None = None,
    ways: Sequence[str] = WAYS,
    pictures: Path | None = None,
) -> None:
    """Renders, reads, builds and compares.

    Args:
        folder: Folder with partnet_mobility and splits.json.
        half: 0 or 1: every other object, from this one on.
        count: Number of objects, evenly spread; default: the whole half.
        ways: What is known; see `WAYS`.
        pictures: Folder for the renderings, each beside the object as it was read, closed and opened.
    """
    splits = json.loads((folder / "splits.json").read_text())
    names = sorted(splits["train"] + splits["val"])[half::2]
    names = names if count is None else [names[k * len(names) // count] for k in range(count)]
    reader = load_reader(READER)
    values: dict[str, list[tuple[float, ...]]] = {way: [] for way in ways}
    head = " | ".join(f"{way}: {', '.join(MEASURED)}" for way in ways)
    print(f"| object | category | read as | {head} | s |\n|{'---|' * (len(ways) + 4)}")
    for name in names:
        start = time.process_time()
        source = read_object(folder / "partnet_mobility" / name, ReaderConfig(samples=POINTS))
        truth = source.asset
        if truth.category not in paper_kinds():
            continue
        image, camera, view = photograph(source, zlib.crc32(name.encode()))
        try:
            reading = look_closer(read_image(image, reader, name), image)
        except ArtigenError as error:
            print(f"| {name} | {truth.category} | {error} |", flush=True)
            continue
        cells, shown = [], []
        for way in ways:
            shape = build(reading, truth, way, view, camera)
            found = shape_to_asset(shape, None, SPACING * float(np.ptp(shape.bounds(), axis=0).max()))
            values[way].append(measure(found, truth))
            cells.append(", ".join(f"{value:.4f}" for value in values[way][-1]))
            shown.append(shape)
        said = " ".join(f"{count} {label}" for label, count in reading.counts.items() if count)
        print(
            f"| {name} | {truth.category} | {reading.kind}: {said} | {' | '.join(cells)} | "
            f"{time.process_time() - start:.1f} |",
            flush=True,
        )
        if pictures is not None:
            _show(image, shown[0]).save(pictures / f"{name}.png")
    print("\n| mean; median | " + " | ".join(MEASURED) + " |\n" + "|---" * (1 + len(MEASURED)) + "|")
    for way, held in values.items():
        said = [f"{column.mean():.4f}; {np.median(column):.4f}" for column in np.array(held).T]
        print(f"| {way} ({len(held)}) | {' | '.join(said)} |")


def _show(image: Image.Image, shape: Shape) -> Image.Image:
    """The rendering, and the object closed and opened."""
    cells = [np.asarray(image.convert("RGB"))]
    cells += [draw_picture(shape, open_parts(shape, share), EDGE) for share in (0.0, 1.0)]
    return Image.fromarray(np.concatenate(cells, axis=1))


if __name__ == "__main__":
    tyro.cli(main)
