"""A small cabinet made of boxes, with exact ground truth: the embedded input of the demo and the tests.

A drawer above a door; behind the door a tray that slides on two runners and a fixed shelf; a bar
handle on the drawer, a vertical one on the door, and a lock knob that turns on the door (a chain of
two joints).
Metres, z up, front -x, floor at z = 0.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.types import FIXED, Asset, Joint, JointType, Part, PartLabel, SurfaceSamples

WOOD = (181, 136, 90)
DARK = (96, 66, 43)
STEEL = (176, 180, 186)
RED = (170, 40, 36)
SPACING = 0.004


@dataclass(frozen=True, kw_only=True)
class SampleBox:
    """An axis-aligned box of a part, from its lowest to its highest corner."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    color: tuple[int, int, int] = WOOD


@dataclass(frozen=True, kw_only=True)
class SamplePart:
    """A part as boxes, with its joint in metres and radians."""

    name: str
    label: PartLabel
    parent: str | None
    boxes: tuple[SampleBox, ...]
    joint: JointType = "fixed"
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    upper: float = 0.0


def _open_box(low, high, wall: float, color=WOOD) -> tuple[SampleBox, ...]:
    """Four walls and a bottom, open at the top."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    return (
        SampleBox(low=(x0, y0, z0), high=(x1, y1, z0 + wall), color=color),
        SampleBox(low=(x0, y0, z0), high=(x0 + wall, y1, z1), color=color),
        SampleBox(low=(x1 - wall, y0, z0), high=(x1, y1, z1), color=color),
        SampleBox(low=(x0, y0, z0), high=(x1, y0 + wall, z1), color=color),
        SampleBox(low=(x0, y1 - wall, z0), high=(x1, y1, z1), color=color),
    )


SAMPLE_PARTS: tuple[SamplePart, ...] = (
    SamplePart(
        name="body",
        label="base",
        parent=None,
        boxes=(
            SampleBox(low=(-0.23, -0.40, 0.0), high=(0.25, -0.38, 1.0)),
            SampleBox(low=(-0.23, 0.38, 0.0), high=(0.25, 0.40, 1.0)),
            SampleBox(low=(-0.23, -0.40, 0.98), high=(0.25, 0.40, 1.0)),
            SampleBox(low=(-0.23, -0.40, 0.0), high=(0.25, 0.40, 0.05)),
            SampleBox(low=(0.23, -0.40, 0.0), high=(0.25, 0.40, 1.0)),
            SampleBox(low=(-0.23, -0.38, 0.70), high=(0.23, 0.38, 0.72)),
            SampleBox(low=(-0.21, -0.38, 0.09), high=(0.23, -0.30, 0.12)),
            SampleBox(low=(-0.21, 0.30, 0.09), high=(0.23, 0.38, 0.12)),
        ),
    ),
    SamplePart(
        name="shelf",
        label="shelf",
        parent="body",
        boxes=(SampleBox(low=(-0.18, -0.38, 0.44), high=(0.23, 0.38, 0.46)),),
    ),
    SamplePart(
        name="drawer",
        label="drawer",
        parent="body",
        boxes=(
            SampleBox(low=(-0.25, -0.40, 0.72), high=(-0.23, 0.40, 0.99), color=DARK),
            *_open_box((-0.23, -0.345, 0.755), (0.18, 0.345, 0.93), 0.015),
        ),
        joint="prismatic",
        axis=(-1.0, 0.0, 0.0),
        upper=0.36,
    ),
    SamplePart(
        name="drawer_handle",
        label="handle",
        parent="drawer",
        boxes=(
            SampleBox(low=(-0.30, -0.12, 0.84), high=(-0.285, 0.12, 0.86), color=STEEL),
            SampleBox(low=(-0.29, -0.12, 0.84), high=(-0.25, -0.10, 0.86), color=STEEL),
            SampleBox(low=(-0.29, 0.10, 0.84), high=(-0.25, 0.12, 0.86), color=STEEL),
        ),
    ),
    SamplePart(
        name="door",
        label="door",
        parent="body",
        boxes=(SampleBox(low=(-0.25, -0.40, 0.05), high=(-0.23, 0.40, 0.71), color=DARK),),
        joint="revolute",
        axis=(0.0, 0.0, -1.0),
        origin=(-0.25, 0.40, 0.0),
        upper=float(np.pi / 2),
    ),
    SamplePart(
        name="door_handle",
        label="handle",
        parent="door",
        boxes=(
            SampleBox(low=(-0.30, -0.35, 0.30), high=(-0.285, -0.33, 0.56), color=STEEL),
            SampleBox(low=(-0.29, -0.35, 0.30), high=(-0.25, -0.33, 0.32), color=STEEL),
            SampleBox(low=(-0.29, -0.35, 0.54), high=(-0.25, -0.33, 0.56), color=STEEL),
        ),
    ),
    SamplePart(
        name="lock",
        label="knob",
        parent="door",
        boxes=(SampleBox(low=(-0.285, -0.28, 0.60), high=(-0.25, -0.23, 0.65), color=RED),),
        joint="continuous",
        axis=(-1.0, 0.0, 0.0),
        origin=(-0.25, -0.255, 0.625),
        upper=float(2 * np.pi),
    ),
    SamplePart(
        name="tray",
        label="tray",
        parent="body",
        boxes=_open_box((-0.19, -0.33, 0.12), (0.20, 0.33, 0.26), 0.015, STEEL),
        joint="prismatic",
        axis=(-1.0, 0.0, 0.0),
        upper=0.30,
    ),
)


def sample_box_arrays(part: SamplePart) -> Float[np.ndarray, "K 2 3"]:
    """Low and high corners of every box of a part, in metres."""
    return np.array([[box.low, box.high] for box in part.boxes])


def _sample_boxes(
    boxes: tuple[SampleBox, ...], rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Uniform points, normals and colors on the faces of boxes."""
    points, normals, colors = [], [], []
    for box in boxes:
        low, high = np.array(box.low), np.array(box.high)
        for axis in range(3):
            area = np.prod(np.delete(high - low, axis))
            count = max(1, round(area / SPACING**2))
            for side, bound in ((-1.0, low), (1.0, high)):
                at = rng.uniform(low, high, size=(count, 3))
                at[:, axis] = bound[axis]
                points.append(at)
                normals.append(np.tile(side * np.eye(3)[axis], (count, 1)))
                colors.append(np.tile(np.array(box.color, dtype=np.uint8), (count, 1)))
    return np.concatenate(points), np.concatenate(normals), np.concatenate(colors)


def sample_asset() -> Asset:
    """The cabinet as an `Asset` with surface samples about `SPACING` metres apart."""
    rng = np.random.default_rng(0)
    corners = np.concatenate([sample_box_arrays(part).reshape(-1, 3) for part in SAMPLE_PARTS])
    low, high = corners.min(axis=0), corners.max(axis=0)
    center, scale = (low + high) / 2, float((high - low).max())
    names = [part.name for part in SAMPLE_PARTS]
    parts, chunks = [], []
    ids: list[Int[np.ndarray, "n"]] = []
    for index, part in enumerate(SAMPLE_PARTS):
        arrays = sample_box_arrays(part)
        box_low, box_high = arrays[:, 0].min(axis=0), arrays[:, 1].max(axis=0)
        per_unit = scale if part.joint == "prismatic" else 1.0
        joint = FIXED
        if part.joint != "fixed":
            joint = Joint(
                type=part.joint,
                axis=np.array(part.axis),
                origin=(np.array(part.origin) - center) / scale,
                upper=part.upper / per_unit,
            )
        parts.append(
            Part(
                name=part.name,
                label=part.label,
                parent=-1 if part.parent is None else names.index(part.parent),
                joint=joint,
                box=np.stack([((box_low + box_high) / 2 - center) / scale, (box_high - box_low) / scale]),
            )
        )
        chunk = _sample_boxes(part.boxes, rng)
        chunks.append(chunk)
        ids.append(np.full(len(chunk[0]), index))
    points, normals, colors = (np.concatenate(column) for column in zip(*chunks, strict=True))
    surface = SurfaceSamples(
        points=(points - center) / scale, normals=normals, colors=colors, part_ids=np.concatenate(ids)
    )
    return Asset(
        name="sample_cabinet", category="StorageFurniture", scale=scale, parts=tuple(parts), surface=surface
    )
