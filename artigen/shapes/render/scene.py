"""Shapes as tensors: every convex solid as an intersection of slabs, plus a circle for cylinders.

A slab is the space between two parallel planes, ``low <= normal . p <= high`` in the primitive's own frame. A
box has three of them; a polytope has one per pair of opposite faces, or per single face with the other side
far away. A cylinder is its bounding box with the first two slabs replaced by the circle.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.shapes.poses import pose_parts
from artigen.shapes.primitives import Primitive
from artigen.shapes.shape import Shape
from artigen.shapes.surfaces.textures import PaintTable, make_paint, place_table

FAR = 1e6
"""Position (m) of the missing side of a slab."""
CYLINDER = 0
"""Group of the cylinders; a polytope's group is the number of slabs it is padded to."""
SLAB_GROUPS = (3, 6, 14, 32, 64, 256)


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """Primitives of all shapes in one list, on one device; poses are float64."""

    shapes: tuple[Shape, ...]
    first: tuple[int, ...]
    """Index of each shape's first primitive, and one past the last."""
    part: Int[Tensor, "P"]
    """Index into the parts of the primitive's shape."""
    center: Float[Tensor, "P 3"]
    rotation: Float[Tensor, "P 3 3"]
    half: Float[Tensor, "P 3"]
    """Half the size of the box about the primitive in its own frame."""
    group: Int[Tensor, "P"]
    groups: tuple[int, ...]
    """Occurring groups, sorted."""
    slab_normal: Float[Tensor, "P S 3"]
    slab_low: Float[Tensor, "P S"]
    slab_high: Float[Tensor, "P S"]
    paint: PaintTable

    @property
    def device(self) -> torch.device:
        """Device of the tensors."""
        return self.center.device


@dataclass(frozen=True, kw_only=True, eq=False)
class Instances:
    """Posed primitives of the images of a batch: each image has its own copies."""

    image: Int[Tensor, "I"]
    primitive: Int[Tensor, "I"]
    rotation: Float[Tensor, "I 3 3"]
    """Own axes as columns, in the world (float64)."""
    center: Float[Tensor, "I 3"]
    to_rest: Float[Tensor, "I 3 4"]
    """Transform from the world to the object frame at rest (float32)."""
    group: Int[Tensor, "I"]
    groups: tuple[int, ...]
    slab_normal: Float[Tensor, "I S 3"]
    """Slab normals in the own frame."""
    slab_low: Float[Tensor, "I S"]
    slab_high: Float[Tensor, "I S"]
    corners: Float[Tensor, "I 8 3"]
    """Corners of the box about the primitive, in the world."""


def build_scene(shapes: Sequence[Shape], device: str | torch.device = "cpu") -> Scene:
    """Prepares shapes for rendering on a device.

    Raises:
        ValueError: If there is no shape, or a primitive has more slabs than supported.
    """
    if not shapes:
        raise ValueError("a scene needs at least one shape")
    owned = [
        (index, primitive)
        for shape in shapes
        for index, part in enumerate(shape.parts)
        for primitive in part.primitives
    ]
    primitives = [primitive for _, primitive in owned]
    counts = [sum(len(part.primitives) for part in shape.parts) for shape in shapes]
    normal, low, high, group = _find_slabs(primitives)
    half = np.stack([primitive.size for primitive in primitives]) / 2

    def tensor(value: np.ndarray) -> Tensor:
        return torch.as_tensor(value, device=device)

    return Scene(
        shapes=tuple(shapes),
        first=tuple(int(v) for v in np.cumsum([0, *counts])),
        part=tensor(np.array([index for index, _ in owned])),
        center=tensor(np.stack([primitive.center for primitive in primitives])),
        rotation=tensor(np.stack([primitive.rotation for primitive in primitives])),
        half=tensor(half),
        group=tensor(group),
        groups=tuple(sorted(set(group.tolist()))),
        slab_normal=tensor(normal),
        slab_low=tensor(low),
        slab_high=tensor(high),
        paint=_join([make_paint(shape) for shape in shapes], torch.zeros(1, device=device)),
    )


def place_instances(
    scene: Scene, shape_ids: Sequence[int], qpos: Sequence[Float[np.ndarray, "Q"]]
) -> Instances:
    """The primitives of one shape per image, at the image's joint coordinates (one per part)."""
    device = scene.device
    starts = [(scene.first[shape_id], scene.first[shape_id + 1]) for shape_id in shape_ids]
    primitive = torch.as_tensor(np.concatenate([np.arange(*bounds) for bounds in starts]), device=device)
    counts = [stop - start for start, stop in starts]
    image = torch.as_tensor(np.repeat(np.arange(len(counts)), counts), device=device)
    poses = _pose_images(scene, shape_ids, qpos)
    row = torch.as_tensor(np.cumsum([0, *(len(pose) for pose in poses)])[:-1], device=device)[image]
    displacement = torch.as_tensor(np.concatenate(poses), device=device)[row + scene.part[primitive]]
    turn = displacement[:, :3, :3]
    rotation = turn @ scene.rotation[primitive]
    center = (turn @ scene.center[primitive][..., None])[..., 0] + displacement[:, :3, 3]
    signs = torch.cartesian_prod(*[torch.tensor([-1.0, 1.0], dtype=torch.float64, device=device)] * 3)
    corners = (signs * scene.half[primitive][:, None]) @ rotation.mT + center[:, None]
    return Instances(
        image=image,
        primitive=primitive,
        rotation=rotation,
        center=center,
        to_rest=torch.cat([turn.mT, -turn.mT @ displacement[:, :3, 3:]], dim=2).float(),
        group=scene.group[primitive],
        groups=scene.groups,
        slab_normal=scene.slab_normal[primitive],
        slab_low=scene.slab_low[primitive],
        slab_high=scene.slab_high[primitive],
        corners=corners,
    )


def _pose_images(
    scene: Scene, shape_ids: Sequence[int], qpos: Sequence[Float[np.ndarray, "Q"]]
) -> list[Float[np.ndarray, "Q 4 4"]]:
    """Displacements of the parts of each image's shape; images of one shape are posed together."""
    poses: dict[int, np.ndarray] = {}
    for shape_id in sorted(set(shape_ids)):
        images = [image for image, owner in enumerate(shape_ids) if owner == shape_id]
        posed = pose_parts(scene.shapes[shape_id], np.stack([qpos[image] for image in images]))
        poses |= dict(zip(images, posed, strict=True))
    return [poses[image] for image in range(len(shape_ids))]


def _find_slabs(primitives: Sequence[Primitive]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Normals, low and high sides, padded with slabs that contain everything, and the group of each."""
    slabs = [_slabs_of(primitive) for primitive in primitives]
    most = max(len(low) for _, low, _ in slabs)
    if most > SLAB_GROUPS[-1]:
        raise ValueError(f"a primitive has {most} directions of faces, expected at most {SLAB_GROUPS[-1]}")
    width = next(size for size in SLAB_GROUPS if size >= most)
    normal = np.zeros((len(slabs), width, 3))
    low, high = np.full((len(slabs), width), -FAR), np.full((len(slabs), width), FAR)
    group = np.zeros(len(slabs), dtype=np.int64)
    for row, (directions, bottoms, tops) in enumerate(slabs):
        count = len(bottoms)
        normal[row, :count], low[row, :count], high[row, :count] = directions, bottoms, tops
        if primitives[row].kind == "polytope":
            group[row] = next(size for size in SLAB_GROUPS if size >= count)
    return normal, low, high, group


def _slabs_of(primitive: Primitive) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    if primitive.kind == "cylinder":
        return np.eye(3), -primitive.size / 2, primitive.size / 2
    normals, offsets = primitive.planes[:, :3], primitive.planes[:, 3]
    opposite = (normals @ normals.T < -1 + 1e-10).argmax(axis=1)  # 0 if there is none
    paired = np.einsum("ij,ij->i", normals, normals[opposite]) < -1 + 1e-10
    kept = np.flatnonzero(~paired | (opposite > np.arange(len(normals))))
    low = np.where(paired[kept], offsets[opposite[kept]], -FAR)
    return normals[kept], low, -offsets[kept]


def _join(tables: Sequence[PaintTable], like: Tensor) -> PaintTable:
    """One table for several objects: rows follow the primitives of the scene."""
    names = list(vars(tables[0]))
    joined = {name: np.concatenate([getattr(table, name) for table in tables]) for name in names}
    return place_table(PaintTable(**joined), like)
