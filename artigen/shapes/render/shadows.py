"""Occlusion of light: exact shadows of a distant light, and nearness of walls in the picture."""

from dataclasses import dataclass
from math import pi, sqrt

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from artigen.shapes.primitives import Vector
from artigen.shapes.render.cameras import Cameras, camera_axes, locate_pixels, pixel_sizes
from artigen.shapes.render.rays import Surface
from artigen.shapes.render.scene import CYLINDER, Instances
from artigen.shapes.render.spans import count_up, pick

POINTS_PER_TILE = 16
"""Average number of points per tile, which determines the number of tiles."""
CLEAR = 1e-3
"""Offset (m) of shadows from a surface."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Blockers:
    """Solids as seen from a distant light, which shines along -z of its frame (float32).

    A ray from (u, v, w) to the light enters slab k at ``low - u_slope * u - v_slope * v - w``; the same
    with ``high`` where it leaves.
    """

    low: Float[Tensor, "I S"]
    high: Float[Tensor, "I S"]
    u_slope: Float[Tensor, "I S"]
    v_slope: Float[Tensor, "I S"]
    bounds: Float[Tensor, "I 2 3"]
    """Smallest and largest u, v, w."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Tiles:
    """A square grid of each image, as seen from the light."""

    low: Float[Tensor, "B 2"]
    size: Float[Tensor, "B 2"]
    """Edge lengths of one tile."""
    edge: int
    """Tiles per edge."""


def find_lit(
    instances: Instances, image: Int[Tensor, "N"], points: Float[Tensor, "N 3"], light: Vector
) -> Bool[Tensor, "N"]:
    """Whether points of the images see the distant light; ``light`` is the unit direction towards it."""
    frame = _light_frame(light, points.device)
    blockers = _find_blockers(instances, frame)
    local = points @ frame.float().T
    tiles = _lay_tiles(instances, blockers, len(points))
    lit = torch.ones(len(points), dtype=torch.bool, device=points.device)
    place = (local[:, :2] - tiles.low.index_select(0, image)) / tiles.size.index_select(0, image)
    shaded = ((place >= 0) & (place <= tiles.edge)).all(dim=1).nonzero()[:, 0]
    cell = place[shaded].long().clamp(max=tiles.edge - 1)
    tile, order = ((image[shaded] * tiles.edge + cell[:, 1]) * tiles.edge + cell[:, 0]).sort()
    shaded = shaded[order]
    lit[shaded] = _find_lit_in_tiles(instances, blockers, frame, tiles, tile, local[shaded])
    return lit


def _find_lit_in_tiles(
    instances: Instances,
    blockers: Blockers,
    frame: Float[Tensor, "3 3"],
    tiles: Tiles,
    tile: Int[Tensor, "N"],
    local: Float[Tensor, "N 3"],
) -> Bool[Tensor, "N"]:
    """`find_lit` for points sorted by tile, in the light's frame."""
    count = torch.bincount(tile, minlength=len(tiles.low) * tiles.edge**2)
    first = count.cumsum(0) - count
    lowest = torch.full(count.shape, torch.inf, device=local.device)
    lowest = lowest.scatter_reduce_(0, tile, local[:, 2], "amin")
    instance, cell = _cover_tiles(instances, blockers, tiles, lowest)
    places = local.T.contiguous()
    lit = torch.ones(len(local), dtype=torch.bool, device=local.device)
    for size in instances.groups:
        chosen = (instances.group[instance] == size).nonzero()[:, 0]
        for piece in chosen.split(_lines_at_once(count[cell[chosen]])):
            line = torch.repeat_interleave(count[cell[piece]])
            point = count_up(count[cell[piece]]) + first[cell[piece]].index_select(0, line)
            block = _block(
                instances, blockers, frame, instance[piece], line, places.index_select(1, point), size
            )
            lit[point.index_select(0, block.nonzero()[:, 0])] = False
    return lit


def _lines_at_once(counts: Int[Tensor, "K"]) -> int:
    """Number of runs of pairs processed together: on a CPU limited by its cache, else large."""
    pairs = 2**16 if counts.device.type == "cpu" else 2**24
    return max(1, int(pairs * len(counts) / max(1, int(counts.sum()))))


def find_openness(
    cameras: Cameras, surface: Surface, turn: Int[Tensor, "N"], *, reach: float, samples: int
) -> Float[Tensor, "N"]:
    """1 in the open, less if the picture shows walls within ``reach`` (m) that rise around a point.

    Points of another ``turn`` sample other directions, so that the sub-rays of a pixel complement each other.
    """
    size = cameras.height * cameras.width
    depths = torch.zeros(len(cameras.fov) * size, device=surface.depth.device)
    depths.scatter_reduce_(0, surface.pixel, surface.depth, "amax")  # what is behind glass
    depths = torch.where(depths > 0, depths, 1e3)
    image, row, column = locate_pixels(cameras, surface.pixel)
    pixel = pixel_sizes(cameras).float().index_select(0, image)
    steps = torch.arange(samples, device=depths.device)[:, None]
    radius = reach / (surface.depth * pixel) * ((steps + 0.7) / samples).sqrt()
    angle = steps * pi * (3 - sqrt(5)) + turn
    columns = (column + radius * angle.cos()).round().long().clamp(0, cameras.width - 1)
    rows = (row + radius * angle.sin()).round().long().clamp(0, cameras.height - 1)
    there = depths.take(image * size + rows * cameras.width + columns)
    axes = camera_axes(cameras).float().index_select(0, image)
    right, down, forward = torch.bmm(axes, surface.normal[:, :, None])[:, :, 0].unbind(dim=1)
    middle_x, middle_y = cameras.width / 2 - 0.5, cameras.height / 2 - 0.5
    dx = pixel * ((columns - middle_x) * there - (column - middle_x) * surface.depth)
    dy = pixel * ((rows - middle_y) * there - (row - middle_y) * surface.depth)
    dz = there - surface.depth
    square = dx * dx + dy * dy + dz * dz + 1e-8
    rise = (dx * right + dy * down + dz * forward) * square.rsqrt()
    near = (1.0 - square / (1.5 * reach) ** 2).clamp(min=0.0)
    blocked = ((rise - 0.08).clamp(min=0.0) * near).mean(dim=0)
    return (1.0 - 1.6 * blocked).clamp(min=0.0)


def _light_frame(light: Vector, device: torch.device) -> Float[Tensor, "3 3"]:
    """Rows u, v, w of a frame with w towards the light (float64)."""
    w = torch.nn.functional.normalize(torch.tensor(light, dtype=torch.float64, device=device), dim=0)
    helper = torch.tensor([0.0, 1.0, 0.0], dtype=torch.float64, device=device)
    u = torch.nn.functional.normalize(torch.linalg.cross(helper, w), dim=0)
    return torch.stack([u, torch.linalg.cross(w, u), w])


def _find_blockers(instances: Instances, frame: Float[Tensor, "3 3"]) -> Blockers:
    own = instances.slab_normal @ instances.rotation.mT
    offset = (own @ instances.center[:, :, None])[..., 0]
    slope = own @ frame.T
    speed = slope[..., 2]
    speed = torch.where(speed.abs() < 1e-6, 1e-6, speed)
    one, other = (instances.slab_low + offset) / speed, (instances.slab_high + offset) / speed
    corners = instances.corners @ frame.T
    return Blockers(
        low=torch.minimum(one, other).float(),
        high=torch.maximum(one, other).float(),
        u_slope=(slope[..., 0] / speed).float(),
        v_slope=(slope[..., 1] / speed).float(),
        bounds=torch.stack([corners.amin(dim=1), corners.amax(dim=1)], dim=1).float(),
    )


def _lay_tiles(instances: Instances, blockers: Blockers, points: int) -> Tiles:
    """A grid over the blockers of each image; points outside are lit."""
    images = int(instances.image[-1]) + 1
    place = instances.image[:, None].expand(-1, 2)
    low = torch.full((images, 2), torch.inf, device=place.device)
    low = low.scatter_reduce_(0, place, blockers.bounds[:, 0, :2], "amin")
    high = torch.full((images, 2), -torch.inf, device=place.device)
    high = high.scatter_reduce_(0, place, blockers.bounds[:, 1, :2], "amax")
    edge = min(max(int(sqrt(points / images / POINTS_PER_TILE)), 8), 64)
    return Tiles(low=low, size=(high - low) / edge, edge=edge)


def _cover_tiles(
    instances: Instances, blockers: Blockers, tiles: Tiles, lowest: Float[Tensor, "T"]
) -> tuple[Int[Tensor, "K"], Int[Tensor, "K"]]:
    """Pairs of an instance and a tile that it may shade; ``lowest`` is the smallest w of a tile's points."""
    low, size, edge = tiles.low[instances.image], tiles.size[instances.image], tiles.edge
    start = ((blockers.bounds[:, 0, :2] - low) / size - 1e-3).long().clamp(0, edge - 1)
    stop = ((blockers.bounds[:, 1, :2] - low) / size + 1e-3).long().clamp(0, edge - 1)
    extent = stop - start + 1
    counts = extent.prod(dim=1)
    instance = torch.repeat_interleave(counts)
    rank, width = count_up(counts), extent[instance, 0]
    down = torch.div(rank, width, rounding_mode="floor")
    tile = (instances.image[instance] * edge + start[instance, 1] + down) * edge
    tile = tile + start[instance, 0] + rank - down * width
    kept = blockers.bounds[instance, 1, 2] > lowest[tile] + CLEAR
    return instance[kept], tile[kept]


def _block(
    instances: Instances,
    blockers: Blockers,
    frame: Float[Tensor, "3 3"],
    instance: Int[Tensor, "K"],
    line: Int[Tensor, "M"],
    places: Float[Tensor, "3 M"],
    size: int,
) -> Bool[Tensor, "M"]:
    """Mask of pairs of an instance (``instance[line]``) and a place in the light's frame that are in
    shadow."""
    u, v, w = places
    slabs = slice(2, 3) if size == CYLINDER else slice(0, size)
    low, high, u_slope, v_slope = (
        pick(value[:, slabs][instance], line)
        for value in (blockers.low, blockers.high, blockers.u_slope, blockers.v_slope)
    )
    shift = u_slope * u + v_slope * v
    enter = (low - shift).amax(dim=0)
    leave = (high - shift).amin(dim=0)
    if size == CYLINDER:
        enter, leave = _narrow_to_cylinder(instances, frame, instance, line, places, enter, leave)
    return (enter <= leave) & (leave > w + CLEAR)


def _narrow_to_cylinder(
    instances: Instances,
    frame: Float[Tensor, "3 3"],
    instance: Int[Tensor, "K"],
    line: Int[Tensor, "M"],
    places: Float[Tensor, "3 M"],
    enter: Float[Tensor, "M"],
    leave: Float[Tensor, "M"],
) -> tuple[Float[Tensor, "M"], Float[Tensor, "M"]]:
    """Restricts the interval of a ray to the light to the round side; w counts from the origin."""
    own = (frame @ instances.rotation[instance]).mT.float()  # rows: own axes in the light's frame
    shift = (instances.rotation[instance].mT @ instances.center[instance][:, :, None])[:, :, 0].float()
    x_axis, y_axis = own[:, 0], own[:, 1]
    dx, dy = x_axis[:, 2], y_axis[:, 2]
    dx = torch.where(dx.abs() + dy.abs() < 1e-3, 1e-3, dx)
    square = dx * dx + dy * dy
    along = (x_axis * dx[:, None] + y_axis * dy[:, None]) / square[:, None]
    aside = (x_axis * dy[:, None] - y_axis * dx[:, None]) / square[:, None]
    along_shift = (shift[:, 0] * dx + shift[:, 1] * dy) / square
    aside_shift = (shift[:, 0] * dy - shift[:, 1] * dx) / square
    reach = instances.slab_high[instance, 0].float() ** 2 / square
    u, v, _ = places
    forms = torch.stack([aside[:, 0], aside[:, 1], aside_shift, along[:, 0], along[:, 1], along_shift, reach])
    aside_u, aside_v, aside_shift, along_u, along_v, along_shift, reach = forms.index_select(1, line)
    off = aside_u * u + aside_v * v - aside_shift
    middle = along_shift - along_u * u - along_v * v
    room = reach - off * off
    half = room.clamp(min=0.0).sqrt()
    leave = torch.where(room < 0, -torch.inf, torch.minimum(leave, middle + half))
    return torch.maximum(enter, middle - half), leave
