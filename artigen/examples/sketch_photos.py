"""Training photos of the sketch network: objects from many sides, some with one part open.

Each picture is stored with its labels: the part label at the centre of each cell, the middles of the parts in
view, and the direction of the camera. `vary_photos` adds backgrounds, colour casts, blur and grain when a
picture is used.
"""

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from jaxtyping import Bool, Float, Int, UInt8
from torch import Tensor
from torch.nn import functional

from artigen.camera import Camera, frame_points
from artigen.examples.mesh_pictures import pack_picture
from artigen.examples.photographs import find_direction
from artigen.examples.shards import split_rows
from artigen.models.batch import TensorBatch
from artigen.shapes.poses import place_posed
from artigen.shapes.render import RenderConfig, batch_cameras, build_scene, render
from artigen.shapes.shape import Shape
from artigen.sketch.picture import CELL
from artigen.types import PART_LABELS

EDGE = 256
"""Pixels of a picture's edge."""
NOTHING = len(PART_LABELS)
"""Label of a cell that shows no part."""
IN_VIEW = 4
"""Least number of pixels of a part for it to be in view."""
NEAR, FAR = (0.6, 0.3), (0.9, 0.7)
"""Largest yaw to either side and largest pitch (radians) of half of the cameras, and of the others."""
OPEN = 0.2
"""Share of the objects with one part open, by any amount."""
PLAIN = 0.85
"""Share of the pictures without a background."""
ZOOM, SHIFT = 0.09, 0.05
"""Largest change of scale, and largest shift as a share of the edge."""
SMALL = 0.6
"""Least scale of an object before a background."""
GAIN, CAST, GAMMA, GRAIN, BLUR = 0.2, 0.06, 0.25, 0.03, 1.2
"""Largest change of brightness, of single colour channels and of the logarithm of gamma; largest standard
deviations of noise, and of the blur in pixels."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Photo:
    """A picture of an object, with its labels."""

    rgba: UInt8[np.ndarray, "S S 4"]
    """Premultiplied on black."""
    labels: UInt8[np.ndarray, "s s"]
    """Label at the centre of each cell, `NOTHING` where there is none."""
    spots: Float[np.ndarray, "N 3"]
    """Parts in view: label, then the middle of the visible pixels, right and down from -1 to 1."""
    view: Float[np.ndarray, "3"]
    """Yaw and pitch of the camera (radians), and half the diagonal of the object over its distance."""


def take_photos(shapes: Sequence[Shape], rng: np.random.Generator) -> list[Photo]:
    """Renders objects from random directions in front, closed or with one part open, in one random light."""
    poses = [_open_part(shape, rng) for shape in shapes]
    cameras = batch_cameras(
        [_place_camera(shape, qpos, rng) for shape, qpos in zip(shapes, poses, strict=True)]
    )
    light = RenderConfig(
        lamp=(-rng.uniform(0.3, 1.0), rng.uniform(-0.8, 0.8), rng.uniform(0.3, 1.0)),
        lamp_strength=rng.uniform(0.3, 0.8),
        fill_strength=rng.uniform(0.2, 0.5),
        shadow_rays=int(rng.random() < 0.8),
        openness=bool(rng.random() < 0.8),
    )
    scene = build_scene(shapes)
    seen = render(scene, cameras, poses, shape_ids=range(len(shapes)), cfg=light)
    rgb, mask, parts, position = (
        values.numpy() for values in (seen.rgb, seen.mask, seen.part_ids, cameras.position)
    )
    return [
        _label_photo(shape, rgb[index], mask[index], parts[index], position[index])
        for index, shape in enumerate(shapes)
    ]


def _open_part(shape: Shape, rng: np.random.Generator) -> Float[np.ndarray, "Q"]:
    """Joint coordinates: closed, or one part open by any amount."""
    qpos = np.zeros(len(shape.parts))
    free = [k for k, part in enumerate(shape.parts) if part.joint is not None and not part.needs]
    if free and rng.random() < OPEN:
        part = int(rng.choice(free))
        motion = shape.parts[part].joint
        assert motion is not None
        qpos[part] = rng.random() * min(motion.upper, 2.0)
    return qpos


def _place_camera(shape: Shape, qpos: Float[np.ndarray, "Q"], rng: np.random.Generator) -> Camera:
    wide, high = NEAR if rng.random() < 0.5 else FAR
    yaw, pitch = rng.uniform(-wide, wide), rng.uniform(-0.08, high)
    way = find_direction(yaw, pitch)
    points = place_posed(shape, qpos)
    return frame_points(points, way, fov=rng.uniform(14.0, 55.0), width=EDGE, height=EDGE)


def _label_photo(
    shape: Shape,
    rgb: Float[np.ndarray, "S S 3"],
    mask: Bool[np.ndarray, "S S"],
    parts: Int[np.ndarray, "S S"],
    position: Float[np.ndarray, "3"],
) -> Photo:
    names = np.array([PART_LABELS.index(part.label) for part in shape.parts])
    first, last = shape.bounds()
    away = position - (first + last) / 2
    distance = float(np.linalg.norm(away))
    near = float(np.linalg.norm(last - first)) / 2 / distance
    return Photo(
        rgba=pack_picture(rgb, mask),
        labels=np.where(mask, names[parts], NOTHING)[CELL // 2 :: CELL, CELL // 2 :: CELL].astype(np.uint8),
        spots=_find_spots(np.where(mask, parts, len(names)), names),
        view=np.array([np.arctan2(away[1], -away[0]), np.arcsin(away[2] / distance), near]),
    )


def _find_spots(parts: Int[np.ndarray, "S S"], names: Int[np.ndarray, "P"]) -> Float[np.ndarray, "N 3"]:
    """Label and place of the parts in view; pixels without a part hold ``len(names)``."""
    count, flat = len(names) + 1, parts.ravel()
    pixels = np.bincount(flat, minlength=count)[: len(names)]
    seen = np.flatnonzero(pixels >= IN_VIEW)
    rows, columns = np.indices(parts.shape)
    sums = [np.bincount(flat, places.ravel() + 0.5, count)[seen] for places in (columns, rows)]
    return np.column_stack([names[seen], *(2.0 * one / pixels[seen] / len(parts) - 1.0 for one in sums)])


def pack_photos(photos: Sequence[Photo]) -> dict[str, np.ndarray]:
    """Photos as arrays, their pictures as PNG."""
    pictures = [np.frombuffer(_to_png(photo.rgba), dtype=np.uint8) for photo in photos]
    return {
        "pictures": np.concatenate(pictures),
        "picture_bytes": np.array([len(picture) for picture in pictures]),
        "labels": np.stack([photo.labels for photo in photos]),
        "spots": np.concatenate([photo.spots for photo in photos]).astype(np.float32),
        "spot_counts": np.array([len(photo.spots) for photo in photos]),
        "views": np.stack([photo.view for photo in photos]).astype(np.float32),
    }


@dataclass(frozen=True, kw_only=True, eq=False)
class PackedPhoto:
    """A photo whose picture is still compressed."""

    png: bytes
    labels: UInt8[np.ndarray, "s s"]
    spots: Float[np.ndarray, "N 3"]
    view: Float[np.ndarray, "3"]


def unpack_photos(arrays: Mapping[str, np.ndarray]) -> list[PackedPhoto]:
    """Inverts `pack_photos`, apart from the PNG."""
    pictures = split_rows(arrays["pictures"], arrays["picture_bytes"])
    spots = split_rows(arrays["spots"], arrays["spot_counts"])
    return [
        PackedPhoto(png=picture.tobytes(), labels=labels, spots=own, view=view)
        for picture, labels, own, view in zip(pictures, arrays["labels"], spots, arrays["views"], strict=True)
    ]


@dataclass(frozen=True, kw_only=True, eq=False)
class PhotoBatch(TensorBatch):
    """A batch of photos with their labels."""

    image: Float[Tensor, "B 4 S S"]
    labels: Int[Tensor, "B s s"]
    kinds: Int[Tensor, "B N"]
    """Labels of the parts in view."""
    centers: Float[Tensor, "B N 2"]
    given: Tensor
    """Mask of the rows that are parts, bool [B, N]."""
    view: Float[Tensor, "B 3"]


def gather_photos(photos: Sequence[PackedPhoto]) -> PhotoBatch:
    """Unpacks photos into a batch."""
    from PIL import Image

    most = max(1, *(len(photo.spots) for photo in photos))
    spots = np.zeros((len(photos), most, 3), dtype=np.float32)
    for row, photo in zip(spots, photos, strict=True):
        row[: len(photo.spots)] = photo.spots
    number = torch.tensor([len(photo.spots) for photo in photos])
    images = np.stack([np.asarray(Image.open(io.BytesIO(photo.png))) for photo in photos])
    return PhotoBatch(
        image=torch.from_numpy(images).permute(0, 3, 1, 2).float() / 255.0,
        labels=torch.from_numpy(np.stack([photo.labels for photo in photos]).astype(np.int64)),
        kinds=torch.from_numpy(spots[..., 0].astype(np.int64)),
        centers=torch.from_numpy(spots[..., 1:]),
        given=torch.arange(most) < number[:, None],
        view=torch.from_numpy(np.stack([photo.view for photo in photos])),
    )


def vary_photos(photos: PhotoBatch, generator: torch.Generator, edge: int = EDGE) -> PhotoBatch:
    """Augments photos: scale, shift, colours, blur, noise, and backgrounds for some.

    Args:
        edge: Edge of the returned pictures in pixels; a multiple of `CELL`.
    """
    count, _, taken, _ = photos.image.shape

    def chance(*shape: int) -> Tensor:
        return torch.rand(shape, generator=generator, device=generator.device)

    def within(limit: float, *shape: int) -> Tensor:
        return limit * (2.0 * chance(*shape) - 1.0)

    before = chance(count) >= PLAIN
    zoom = 1.0 / torch.where(before, 1.0 - (1.0 - SMALL) * chance(count), 1.0 + within(ZOOM, count))
    scale = zoom[:, None].expand(-1, 2)
    shift = 2.0 * within(SHIFT, count, 2)
    affine = torch.cat([torch.diag_embed(scale), shift[..., None]], dim=2)
    grid = functional.affine_grid(affine, [count, 1, edge, edge], align_corners=False)
    image = functional.grid_sample(photos.image, grid, align_corners=False)
    coarse = functional.affine_grid(affine, [count, 1, edge // CELL, edge // CELL], align_corners=False)
    marks = (photos.labels[:, None] - NOTHING).to(image.dtype)  # padding with 0 then means `NOTHING`
    labels = functional.grid_sample(marks, coarse, mode="nearest", align_corners=False).round().long()
    alpha = image[:, 3:]
    color = (image[:, :3] / alpha.clamp(min=1e-2)).clamp(0.0, 1.0)
    color = color ** torch.exp(within(GAMMA, count, 1, 1, 1)) * (1.0 + within(GAIN, count, 1, 1, 1))
    color = color * (1.0 + within(CAST, count, 3, 1, 1))
    patches = functional.interpolate(chance(count, 3, 4, 4) - 0.5, edge, mode="bilinear")
    behind = chance(count, 3, 1, 1) + 0.3 * patches
    color = torch.where(before[:, None, None, None], alpha * color + (1 - alpha) * behind, color)
    alpha = torch.where(before[:, None, None, None], 1.0, alpha)
    color = _blur(color * alpha, chance(count) * BLUR * edge / taken)
    noise = torch.randn(color.shape, generator=generator, device=generator.device)
    color = color + GRAIN * chance(count, 1, 1, 1) * noise * alpha
    return replace(
        photos,
        image=torch.cat([color.clamp(0.0, 1.0), alpha], dim=1),
        labels=labels[:, 0] + NOTHING,
        centers=(photos.centers - shift[:, None]) / scale[:, None],
    )


def _blur(image: Float[Tensor, "B 3 S S"], sigma: Float[Tensor, "B"]) -> Float[Tensor, "B 3 S S"]:
    """Blurs each picture with a Gaussian of its own standard deviation (pixels)."""
    steps = torch.arange(-3, 4, device=image.device)
    weights = torch.exp(-0.5 * (steps / sigma.clamp(min=0.1)[:, None]) ** 2)
    weights = (weights / weights.sum(dim=1, keepdim=True)).repeat_interleave(3, dim=0)
    flat = image.flatten(0, 1)[None]
    flat = functional.conv2d(flat, weights[:, None, None, :], padding=(0, 3), groups=flat.shape[1])
    flat = functional.conv2d(flat, weights[:, None, :, None], padding=(3, 0), groups=flat.shape[1])
    return flat[0].unflatten(0, image.shape[:2])


def _to_png(rgba: UInt8[np.ndarray, "S S 4"]) -> bytes:
    from PIL import Image

    out = io.BytesIO()
    Image.fromarray(rgba).save(out, format="PNG", compress_level=1)
    return out.getvalue()
