"""Surfaces in one Intel Embree scene: hits with attributes, also behind panes, and occlusion."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from artigen.splats.colors import linear_from_srgb
from artigen.types import frozen_array
from sim_export.picture.shading import (
    blend_corners,
    dot_rows,
    sample_cover,
    sample_texture,
)

# embreex is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

OPAQUE = 0.99
"""Opacity above which a surface hides what is behind it."""
MOST_LAYERS = 8
"""Largest number of transparent surfaces along a ray."""
BEYOND = 1e-5
"""Offset behind a transparent surface from which the next one is searched, relative to the scene's
diagonal."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Surface:
    """Triangles with unshared corners, ready for drawing, and their number in an id image.

    ``uv`` and ``texture`` as in `Mesh`; coordinates outside [0, 1] repeat the texture. ``color`` is sRGB in
    [0, 1].
    """

    triangles: Float[np.ndarray, "F 3 3"]
    normals: Float[np.ndarray, "F 3 3"]
    id: int = 0
    uv: Float[np.ndarray, "F 3 2"] | None = None
    texture: UInt8[np.ndarray, "H W C"] | None = None
    color: tuple[float, float, float] = (0.7, 0.7, 0.7)

    def __post_init__(self) -> None:
        triangles = frozen_array(self.triangles, np.float64, (None, 3, 3), "surface triangles")
        normals = frozen_array(self.normals, np.float64, (len(triangles), 3, 3), "surface normals")
        object.__setattr__(self, "triangles", triangles)
        object.__setattr__(self, "normals", normals)
        if (self.uv is None) != (self.texture is None):
            raise ValueError("a surface has texture coordinates and a texture, or neither")
        if self.uv is not None:
            object.__setattr__(
                self, "uv", frozen_array(self.uv, np.float64, (len(triangles), 3, 2), "surface uv")
            )
        if self.id < 0:
            raise ValueError(f"surface id is {self.id}, allowed is 0 and above (-1 means background)")

    @property
    def clear(self) -> bool:
        """Whether any part of it is transparent."""
        return self.texture is not None and self.texture.shape[2] == 4

    @property
    def repeats(self) -> bool:
        """Whether texture coordinates exceed [0, 1]."""
        uv = self.uv
        return uv is not None and len(uv) > 0 and bool(uv.min() < -1e-3 or uv.max() > 1.0 + 1e-3)


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """All triangles of some surfaces, with Embree's hierarchy.

    Drawing programs often store a face twice, with opposite windings and two materials. Only one of such
    twins is in the hierarchy, and a ray sees the one whose front it hits. For this, the corners of every
    triangle are sorted by position; twins then have equal corners.
    """

    surfaces: tuple[Surface, ...]
    owner: Int[np.ndarray, "T"]
    """Index of each triangle's surface."""
    corners: Int[np.ndarray, "T 3"]
    """Each triangle's sorted corners, as indices into all corners, one surface after the other."""
    triangles: Float[np.ndarray, "K 3 3"]
    """Sorted corners of the triangles in the hierarchy, float32."""
    twins: Int[np.ndarray, "K 2"]
    """Per triangle in the hierarchy: the faces visible against and along its normal."""
    tree: object | None
    """embreex scene; None if there are no triangles."""

    @cached_property
    def normals(self) -> Float[np.ndarray, "K 3"]:
        """Normals of the sorted corners, not normalised."""
        edges = self.triangles[:, 1:] - self.triangles[:, :1]
        return np.cross(edges[:, 0], edges[:, 1])

    @cached_property
    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Lowest and highest corner of all triangles."""
        corners = self.triangles.reshape(-1, 3)
        return np.stack([corners.min(axis=0), corners.max(axis=0)])

    @property
    def diagonal(self) -> float:
        """Length of the diagonal of the bounds."""
        return float(np.linalg.norm(self.bounds[1] - self.bounds[0]))

    @cached_property
    def corner_normals(self) -> Float[np.ndarray, "C 3"]:
        """Shading normals of all corners, float32."""
        return np.concatenate([surface.normals.reshape(-1, 3) for surface in self.surfaces]).astype(
            np.float32
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Hits:
    """Rays that hit a triangle: index, position on the triangle, depth, and face normal.

    ``triangle`` indexes all triangles of all surfaces, ``weights`` refer to its sorted corners, ``normals``
    have either orientation and are not normalised.
    """

    place: Int[np.ndarray, "N"]
    triangle: Int[np.ndarray, "N"]
    weights: Float[np.ndarray, "N 3"]
    depth: Float[np.ndarray, "N"]
    normals: Float[np.ndarray, "N 3"]


def build_scene(surfaces: Sequence[Surface]) -> Scene:
    """Combines surfaces into one scene; embreex uses float32."""
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    counts = [len(surface.triangles) for surface in surfaces]
    empty = np.zeros((0, 3, 3))
    triangles = np.concatenate([empty, *(surface.triangles for surface in surfaces)]).astype(np.float32)
    places = _number_places(triangles)
    order = np.argsort(places, axis=1)
    shown, twins = _pair_twins(np.take_along_axis(places, order, axis=1), _ODD[order[:, 0], order[:, 1]])
    sorted_triangles = np.take_along_axis(triangles[shown], order[shown][:, :, None], axis=1)
    tree = None
    if len(shown):
        tree = rtcore_scene.EmbreeScene(robust=True)
        TriangleMesh(tree, sorted_triangles)
    return Scene(
        surfaces=tuple(surfaces),
        owner=np.repeat(np.arange(len(counts)), counts),
        corners=order + 3 * np.arange(len(triangles))[:, None],
        triangles=sorted_triangles,
        twins=twins,
        tree=tree,
    )


_ODD = np.array([[False, False, True], [True, False, False], [False, True, False]])
"""Whether the permutation that starts with these two of (0, 1, 2) is odd."""


def _number_places(triangles: np.ndarray) -> np.ndarray:
    """One number per distinct corner position, to within a millionth of the scene's extent."""
    points = triangles.reshape(-1, 3).astype(np.float64)
    if not len(points):
        return np.zeros((0, 3), dtype=np.int64)
    extent = max(float(np.ptp(points, axis=0).max()), 1e-12)
    cells = np.round((points - points.min(axis=0)) / (extent * 1e-6)).astype(np.int64)
    keys = (cells[:, 0] << 42) | (cells[:, 1] << 21) | cells[:, 2]
    return np.unique(keys, return_inverse=True)[1].reshape(-1, 3)


def _pair_twins(places: np.ndarray, odd: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Groups triangles with the same sorted corners: one of each group, and its two faces."""
    if not len(places):
        return np.zeros(0, dtype=np.int64), np.zeros((0, 2), dtype=np.int64)
    members = np.lexsort((odd, *places.T))
    starts = np.append(True, (np.diff(places[members], axis=0) != 0).any(axis=1))
    ends = np.append(starts[1:], True)
    first, last = members[starts], members[ends]
    return first, np.stack([first, np.where(odd[last], last, first)], axis=1)


def cast_layers(
    scene: Scene, origin: Float[np.ndarray, "3"], rays: Float[np.ndarray, "N 3"]
) -> list[tuple[Hits, Float[np.ndarray, "M"]]]:
    """Hits of rays from one origin, layer by layer through transparent surfaces, and their opacity."""
    left, starts = np.arange(len(rays)), np.zeros(len(rays), dtype=np.float32)
    clear = any(surface.clear for surface in scene.surfaces)
    layers: list[tuple[Hits, np.ndarray]] = []
    while len(left) and (clear or not layers) and len(layers) < MOST_LAYERS:
        hits = cast_rays(scene, origin + rays[left] * starts[:, None], rays[left])
        cover = cover_at(scene, hits)
        depth = starts[hits.place] + hits.depth
        layers.append((replace(hits, place=left[hits.place], depth=depth), cover))
        through = cover < OPAQUE
        step = BEYOND * scene.diagonal / np.linalg.norm(rays[left[hits.place]], axis=1)
        left, starts = left[hits.place][through], (depth + step)[through].astype(np.float32)
    return layers


def cast_rays(scene: Scene, origin: Float[np.ndarray, "*N 3"], rays: Float[np.ndarray, "N 3"]) -> Hits:
    """First hit of every ray, from a common or individual origins; depth is in units of each ray's length."""
    if scene.tree is None:
        none, flat = np.zeros(0, dtype=np.int64), np.zeros((0, 3), dtype=np.float32)
        return Hits(place=none, triangle=none, weights=flat, depth=flat[:, 0], normals=flat)
    origins = np.ascontiguousarray(np.broadcast_to(origin.astype(np.float32), rays.shape))
    found = scene.tree.run(origins, rays, output=True)
    place = np.flatnonzero(found["primID"] >= 0)
    shown, u, v = (found[name][place] for name in ("primID", "u", "v"))
    normals = scene.normals[shown]
    along = dot_rows(normals, rays[place]) > 0
    return Hits(
        place=place,
        triangle=scene.twins[shown, along.astype(np.int64)],
        weights=np.stack([1.0 - u - v, u, v], axis=1),
        depth=found["tfar"][place],
        normals=normals,
    )


def are_occluded(
    scene: Scene,
    origins: Float[np.ndarray, "N 3"],
    directions: Float[np.ndarray, "N 3"],
    limits: Float[np.ndarray, "N"],
) -> Bool[np.ndarray, "N"]:
    """True if something lies within ``limits`` (in units of the direction) of the origin."""
    if scene.tree is None or len(origins) == 0:
        return np.zeros(len(origins), dtype=bool)
    return scene.tree.run(origins, directions, limits, query="OCCLUDED") >= 0


def corner_normals_at(scene: Scene, hits: Hits) -> Float[np.ndarray, "N 3"]:
    """Interpolated shading normals at hits, not normalised."""
    return blend_corners(scene.corner_normals[scene.corners[hits.triangle]], hits.weights)


def surface_ids_at(scene: Scene, hits: Hits) -> Int[np.ndarray, "N"]:
    """Ids of the surfaces that were hit."""
    return np.array([surface.id for surface in scene.surfaces], dtype=np.int64)[scene.owner[hits.triangle]]


def albedo_at(scene: Scene, hits: Hits) -> Float[np.ndarray, "N 3"]:
    """Colour of the surface at hits as linear light: its texture, or its plain colour."""
    plain = linear_from_srgb(np.array([surface.color for surface in scene.surfaces]))
    albedo = plain.astype(np.float32)[scene.owner[hits.triangle]]
    for surface, texture, seen, uv in _find_texels(scene, hits):
        albedo[seen] = sample_texture(texture[..., :3], uv, repeat=surface.repeats)
    return albedo


def cover_at(scene: Scene, hits: Hits) -> Float[np.ndarray, "N"]:
    """Opacity of the surface at hits, in [0, 1]."""
    cover = np.ones(len(hits.place), dtype=np.float32)
    if any(surface.clear for surface in scene.surfaces):
        for surface, texture, seen, uv in _find_texels(scene, hits):
            if surface.clear:
                cover[seen] = sample_cover(texture[..., 3], uv, repeat=surface.repeats)
    return cover


def _find_texels(
    scene: Scene, hits: Hits
) -> Iterator[tuple[Surface, UInt8[np.ndarray, "H W C"], Int[np.ndarray, "M"], Float[np.ndarray, "M 2"]]]:
    """Surfaces with a texture, the texture, the hits on each, and their texture coordinates."""
    owner = scene.owner[hits.triangle]
    by_owner = np.argsort(owner, kind="stable")
    bounds = np.searchsorted(owner[by_owner], np.arange(len(scene.surfaces) + 1))
    start = 0  # offset of the surface among all corners
    for index, surface in enumerate(scene.surfaces):
        seen = by_owner[bounds[index] : bounds[index + 1]]
        if surface.uv is not None and surface.texture is not None and len(seen):
            corners = scene.corners[hits.triangle[seen]] - start
            uv = blend_corners(surface.uv.reshape(-1, 2)[corners], hits.weights[seen].astype(np.float64))
            yield surface, surface.texture, seen, uv
        start += 3 * len(surface.triangles)
