"""Intersects pixel rays with primitives: hits, the nearest first, and the surface there.

In the own frame of a primitive, the ray of pixel (column, row) starts at ``o`` and runs along ``d``, which is
linear in column and row; so is its speed through each slab. Ray parameters are depths, because rays have
length one along the viewing direction.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.shapes.render.cameras import Cameras, camera_axes, cast_rays, locate_pixels, pixel_sizes
from artigen.shapes.render.scene import CYLINDER, Instances
from artigen.shapes.render.spans import NEAR, Spans, count_up, find_spans, pick

TOLERANCE = 2e-6
"""Relative depth by which a ray may leave a solid before it enters and still hit, which avoids cracks."""
NOTHING = torch.iinfo(torch.int64).max
STILL = 1e-9
"""Speed through a slab below which a ray counts as parallel to it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Rays:
    """Pixel rays in the own frame of each instance: start and direction (float32)."""

    start: Float[Tensor, "I S"]
    """Position of the camera along each slab's normal."""
    low: Float[Tensor, "I S"]
    """Lower sides of the slabs, relative to the camera."""
    high: Float[Tensor, "I S"]
    radius: Float[Tensor, "I"]
    """Radius of cylinders."""
    column: Float[Tensor, "I S"]
    """Change of the speed through each slab per column."""
    row: Float[Tensor, "I S"]
    middle: Float[Tensor, "I S"]
    """Speed through each slab for a ray through the upper left corner of pixel (0, 0)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Hits:
    """All hits, unordered: ``key`` combines depth (high bits) and instance, so that the smallest is the
    nearest."""

    pixel: Int[Tensor, "M"]
    """Pixel index over all images of the batch."""
    key: Int[Tensor, "M"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Surface:
    """The visible surface of some pixels."""

    pixel: Int[Tensor, "N"]
    instance: Int[Tensor, "N"]
    depth: Float[Tensor, "N"]
    point: Float[Tensor, "N 3"]
    """Point in the world (m)."""
    normal: Float[Tensor, "N 3"]
    """Normal in the world, towards the camera."""
    view: Float[Tensor, "N 3"]
    """Unit direction of the ray."""
    rest_point: Float[Tensor, "N 3"]
    """Point in the object frame at rest."""
    rest_normal: Float[Tensor, "N 3"]


def make_rays(cameras: Cameras, instances: Instances) -> Rays:
    """Rays of all pixels, in the own frames of the instances."""
    axes = camera_axes(cameras)[instances.image]
    start = cameras.position.double()[instances.image] - instances.center
    own = instances.slab_normal @ instances.rotation.mT  # slab normals in the world
    right, down, forward = ((own @ axes[:, k, :, None])[..., 0] for k in range(3))
    pixel = pixel_sizes(cameras)[instances.image][:, None]
    place = (own @ start[:, :, None])[..., 0]
    return Rays(
        start=place.float(),
        low=(instances.slab_low - place).float(),
        high=(instances.slab_high - place).float(),
        radius=instances.slab_high[:, 0].float(),
        column=(right * pixel).float(),
        row=(down * pixel).float(),
        middle=(forward - (right * cameras.width / 2 + down * cameras.height / 2) * pixel).float(),
    )


def find_hits(cameras: Cameras, instances: Instances, rays: Rays) -> Hits:
    """Every instance that every pixel's ray hits in front of the camera."""
    spans = find_spans(cameras, instances)
    group = instances.group[spans.instance]
    pixels, keys = [], []
    for size in instances.groups:
        chosen = (group == size).nonzero()[:, 0]
        found = _hit_group(cameras, instances, rays, _select(spans, chosen), size)
        pixels.append(found[0])
        keys.append(found[1])
    return Hits(pixel=torch.cat(pixels), key=torch.cat(keys))


def find_layers(hits: Hits, pixels: int) -> Iterator[Int[Tensor, "pixels"]]:
    """The nearest key of each pixel, then the next one behind it, and so on; `NOTHING` if none is left."""
    last = torch.full((pixels,), -1, dtype=torch.int64, device=hits.key.device)
    pixel, key = hits.pixel, hits.key
    while True:
        layer = torch.full_like(last, NOTHING).scatter_reduce_(0, pixel, key, "amin")
        yield layer
        behind = key > layer[pixel]
        pixel, key = pixel[behind], key[behind]


def unpack_keys(key: Int[Tensor, "N"]) -> tuple[Float[Tensor, "N"], Int[Tensor, "N"]]:
    """Depth and instance of keys."""
    return (key >> 32).to(torch.int32).view(torch.float32), key & 0xFFFFFFFF


def find_surface(
    cameras: Cameras, instances: Instances, rays: Rays, pixel: Int[Tensor, "N"], key: Int[Tensor, "N"]
) -> Surface:
    """The surface at hits: its point in the world and at rest, and its normal."""
    depth, instance = unpack_keys(key)
    image, row, column = locate_pixels(cameras, pixel)
    across, along = column + 0.5, row + 0.5
    normal = torch.zeros(len(pixel), 3, device=depth.device)
    group = instances.group[instance]
    for size in instances.groups:
        chosen = (group == size).nonzero()[:, 0]
        normal[chosen] = _own_normals(
            instances, rays, instance[chosen], across[chosen], along[chosen], depth[chosen], size
        )
    view = cast_rays(cameras, image, row, column)
    point = cameras.position.float().index_select(0, image) + view * depth[:, None]
    normal = _rotate(instances.rotation.float().index_select(0, instance), normal)
    to_rest = instances.to_rest.index_select(0, instance)
    return Surface(
        pixel=pixel,
        instance=instance,
        depth=depth,
        point=point,
        normal=normal,
        view=view / view.norm(dim=1, keepdim=True),
        rest_point=_rotate(to_rest[:, :, :3], point) + to_rest[:, :, 3],
        rest_normal=_rotate(to_rest[:, :, :3], normal),
    )


def _rotate(matrices: Float[Tensor, "N 3 3"], vectors: Float[Tensor, "N 3"]) -> Float[Tensor, "N 3"]:
    return torch.bmm(matrices, vectors[:, :, None])[:, :, 0]


def _select(spans: Spans, chosen: Int[Tensor, "K"]) -> Spans:
    return Spans(**{name: value.index_select(0, chosen) for name, value in vars(spans).items()})


def _hit_group(
    cameras: Cameras, instances: Instances, rays: Rays, spans: Spans, size: int
) -> tuple[Int[Tensor, "M"], Int[Tensor, "M"]]:
    """Pixels and keys of hits on the instances of one group."""
    line = torch.repeat_interleave(spans.count)
    column = count_up(spans.count) + spans.column.index_select(0, line)
    across = column + 0.5
    slabs = size or 3
    at = spans.instance
    middle, row, low, high = (v[:, :slabs][at] for v in (rays.middle, rays.row, rays.low, rays.high))
    fixed = middle + row * (spans.row + 0.5)[:, None]
    speed = pick(fixed, line) + pick(rays.column[at, :slabs], line) * across
    low, high = pick(low, line), pick(high, line)
    if size == CYLINDER:
        start, radius = pick(rays.start[at, :slabs], line), rays.radius[at].index_select(0, line)
        enter, leave = _meet_cylinder(start, speed, radius, low[2], high[2])
    else:
        enter, leave = _meet_slabs(speed, low, high)
    hit = ((enter <= leave + TOLERANCE * leave) & (enter > NEAR)).nonzero()[:, 0]
    first = (instances.image[at] * cameras.height + spans.row) * cameras.width
    depth, line = enter.index_select(0, hit).view(torch.int32).long(), line.index_select(0, hit)
    pixel = first.index_select(0, line) + column.index_select(0, hit)
    return pixel, (depth << 32) | at.index_select(0, line)


def _meet_slabs(
    speed: Float[Tensor, "S M"], low: Float[Tensor, "S M"], high: Float[Tensor, "S M"]
) -> tuple[Float[Tensor, "M"], Float[Tensor, "M"]]:
    """Parameters at which rays enter the last slab and leave the first."""
    inverse = 1.0 / torch.where(speed.abs() < STILL, STILL, speed)
    one, other = low * inverse, high * inverse
    return torch.minimum(one, other).amax(dim=0), torch.maximum(one, other).amin(dim=0)


def _meet_cylinder(
    start: Float[Tensor, "3 M"],
    speed: Float[Tensor, "3 M"],
    radius: Float[Tensor, "M"],
    low: Float[Tensor, "M"],
    high: Float[Tensor, "M"],
) -> tuple[Float[Tensor, "M"], Float[Tensor, "M"]]:
    """Parameters at which rays enter and leave a cylinder about its own z; for misses the exit precedes the
    entry."""
    (ox, oy, _), (dx, dy, dz) = start, speed
    dx = torch.where(dx.abs() + dy.abs() < 1e-6, 1e-6, dx)
    square = dx * dx + dy * dy
    # Use the distance of the ray from the axis; b * b - a * c loses all digits for thin rods.
    reach = square * radius * radius - (ox * dy - oy * dx) ** 2
    middle, half = -(ox * dx + oy * dy) / square, reach.clamp(min=0.0).sqrt() / square
    enter, leave = _meet_slabs(dz[None], low[None], high[None])
    enter, leave = torch.maximum(enter, middle - half), torch.minimum(leave, middle + half)
    return enter, torch.where(reach < 0, -torch.inf, leave)


def _own_normals(
    instances: Instances,
    rays: Rays,
    instance: Int[Tensor, "N"],
    across: Float[Tensor, "N"],
    along: Float[Tensor, "N"],
    depth: Float[Tensor, "N"],
    size: int,
) -> Float[Tensor, "N 3"]:
    """Outward normals in the own frame of instances of one group, at the depths where rays enter."""
    slabs = size or 3
    middle, row, column, low, high = (
        pick(value[:, :slabs], instance)
        for value in (rays.middle, rays.row, rays.column, rays.low, rays.high)
    )
    speed = middle + row * along + column * across
    inverse = 1.0 / torch.where(speed.abs() < STILL, STILL, speed)
    enter = torch.minimum(low * inverse, high * inverse)
    if size == CYLINDER:
        at = pick(rays.start[:, :slabs], instance) + speed * depth
        on_cap = enter[2] >= depth * (1 - TOLERANCE)
        side = torch.nn.functional.normalize(at[:2], dim=0)
        flat = torch.zeros_like(depth)
        normal = torch.where(
            on_cap, torch.stack([flat, flat, -torch.sign(speed[2])]), torch.cat([side, flat[None]])
        )
        return normal.T
    last = enter.argmax(dim=0)
    away = -torch.sign(speed.gather(0, last[None]))[0]
    return away[:, None] * instances.slab_normal[instance, last].float()
