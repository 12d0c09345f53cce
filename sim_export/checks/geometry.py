"""L1, the shapes: closed and textured visuals, convex hulls, nothing detached (V101, V102, V104 to V107)."""

from dataclasses import replace
from pathlib import PurePosixPath

import numpy as np

from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, always, at_least, at_most, count_problems
from sim_export.checks.subject import Shape, Subject
from sim_export.errors import PackageError
from sim_export.files.obj import parse_mtl, read_image
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import count_polygons, hull_length, hull_width
from sim_export.geometry.islands import hull_islands, visual_islands
from sim_export.geometry.rows import connect_rows, number_rows
from sim_export.geometry.triangles import area_normals, face_edges, find_slivers, triangle_areas
from sim_export.package import Hull

_FILE_PRECISION = 2e-6
"""Precision of coordinates in files (m), which are written in micrometres."""
_SPOTS = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4]]) / np.array([[3], [6], [6], [6]])
"""Sample points on each face: its centre, and halfway to the corners (barycentric)."""


def own_visuals(subject: Subject) -> str:
    """Applies to visual meshes that we made, not to those copied from a source."""
    if subject.has_own_visuals:
        return ""
    return "the visual meshes are the source's own and serve only to be looked at"


def check_visuals(subject: Subject, cfg: CheckConfig) -> Finding:
    """V101: visual meshes are closed, oriented outwards, free of slivers and of moderate size."""
    problems, links = [], []
    for shape, joined in whole_visuals(subject):
        faults = mesh_faults(shape, cfg, joined=joined)
        problems += [(shape.file, f"{shape.file}: {fault}") for fault in faults]
        links += [shape.link] if faults else []
    if not subject.visuals:
        problems.append(("", "no link has a visual mesh"))
    return count_problems(problems, f"{len(subject.visuals)} visual meshes are closed and well shaped", links)


def whole_visuals(subject: Subject) -> list[tuple[Shape, bool]]:
    """The visual meshes, and whether they are joined of several: those of one part that show it by its
    finishes (``NAME``, ``NAME-1``, ...)."""
    groups: dict[str, list[Shape]] = {}
    for shape in subject.visuals:
        groups.setdefault(shape.file.removesuffix(".obj").partition("-")[0], []).append(shape)
    whole = []
    for shapes in groups.values():
        starts = np.cumsum([0, *(len(shape.vertices) for shape in shapes)])
        faces = [shape.faces + start for shape, start in zip(shapes, starts, strict=False)]
        vertices = [shape.vertices for shape in shapes]
        joined = replace(shapes[0], vertices=np.concatenate(vertices), faces=np.concatenate(faces))
        whole.append((joined, True) if len(shapes) > 1 else (shapes[0], False))
    return whole


def mesh_faults(shape: Shape, cfg: CheckConfig, *, joined: bool = False) -> list[str]:
    """Faults of one visual mesh, one sentence each. Where ``joined`` of several, bodies that touch in a point
    share it, so their Euler numbers say nothing."""
    faces = shape.faces
    if not len(faces):
        return ["has no faces"]
    faults = []
    if len(faces) > cfg.max_faces:
        faults.append(f"has {len(faces)} faces, allowed are {cfg.max_faces}")
    open_edges = count_open_edges(faces)
    if open_edges:  # a writer may split vertices along texture seams of a closed surface
        faces = _merge_vertices(shape.vertices, faces)
        open_edges = count_open_edges(faces)
    if open_edges:
        faults.append(f"is open or wound inconsistently along {open_edges} edges")
    else:
        faults += [] if joined else _euler_faults(faces)
        faults += _volume_faults(shape, faces)
    slivers = int(find_slivers(shape.triangles, cfg.sliver_ratio).sum())
    allowed = int(np.ceil(cfg.max_sliver_share * len(shape.faces)))
    if slivers > allowed:
        faults.append(f"has {slivers} degenerate faces, allowed are {allowed}")
    return faults


def _euler_faults(faces: np.ndarray) -> list[str]:
    euler = euler_numbers(faces)
    bad = euler[(euler > 2) | (euler % 2 != 0)]
    return [f"has a piece with Euler number {int(bad[0])}, which no closed surface has"] if len(bad) else []


def _volume_faults(shape: Shape, faces: np.ndarray) -> list[str]:
    """Bodies that enclose nothing, unless they are voids: within the bounds of another one."""
    corners = shape.vertices[faces]
    shares = np.einsum("fi,fi->f", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2]) / 6.0
    piece = connect_rows(face_edges(faces).T, len(shape.vertices))[faces[:, 0]]
    _, piece = np.unique(piece, return_inverse=True)
    volume = np.bincount(piece, weights=shares)
    low, high = np.full((len(volume), 3), np.inf), np.full((len(volume), 3), -np.inf)
    np.minimum.at(low, piece, corners.min(axis=1))
    np.maximum.at(high, piece, corners.max(axis=1))
    full = volume > 0.0
    within = (low[:, None] >= low[full][None]).all(axis=-1) & (high[:, None] <= high[full][None]).all(axis=-1)
    bad = volume[~full & ~within.any(axis=-1)]
    return [f"encloses {1e3 * bad.min():.3g} litres: it is wound inwards or flat"] if len(bad) else []


def count_open_edges(faces: np.ndarray) -> int:
    """Edges with unequal numbers of traversals per direction: 0 for a closed, consistently oriented
    surface."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    _, edge = np.unique(low * (faces.max() + 1) + high, return_inverse=True)
    return int(np.count_nonzero(np.bincount(edge, weights=np.where(start < end, 1, -1))))


def euler_numbers(faces: np.ndarray) -> np.ndarray:
    """Vertices - edges + faces of every connected piece."""
    used, faces = np.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    edges = np.unique(np.sort(face_edges(faces), axis=1), axis=0)
    piece = connect_rows(edges.T, len(used))
    count = int(piece.max()) + 1
    vertices = np.bincount(piece, minlength=count)
    return (
        vertices
        - np.bincount(piece[edges[:, 0]], minlength=count)
        + np.bincount(piece[faces[:, 0]], minlength=count)
    )


def _merge_vertices(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    first, number = number_rows(np.rint(1e9 * vertices).astype(np.int64))
    merged = first[number][faces]
    proper = (merged[:, 0] != merged[:, 1]) & (merged[:, 1] != merged[:, 2]) & (merged[:, 2] != merged[:, 0])
    return merged[proper]


def has_collision(subject: Subject) -> str:
    """Applies if the package has collision geometry."""
    return "" if any(link.collisions for link in subject.links.values()) else "no link has collision geometry"


def check_hulls(subject: Subject, cfg: CheckConfig) -> Finding:
    """V102: every collision shape is one convex hull that PhysX accepts unchanged, also on a GPU."""
    problems, links = [], []
    for shape, hull in zip(subject.collisions, subject.hulls, strict=True):
        where, faults = f"{shape.link}: {shape.file}", hull_faults(shape, hull, cfg)
        problems += [(where, f"{where} {fault}") for fault in faults]
        links += [shape.link] if faults else []
    for name, link in subject.links.items():
        if link.visuals and not link.collisions:
            problems.append((name, f"link {name!r} is visible but has no collision geometry"))
            links.append(name)
    return count_problems(problems, f"{len(subject.hulls)} hulls are convex, compact and thick enough", links)


def hull_faults(shape: Shape, hull: Hull | None, cfg: CheckConfig) -> list[str]:
    """Faults of one collision mesh, one sentence each."""
    if hull is None:
        return [f"has {len(shape.vertices)} vertices without volume"]
    faults = []
    own = _volume(shape.vertices, shape.faces)
    ratio = own / _volume(hull.vertices, hull.faces)
    if not cfg.convex_volume_ratio <= ratio <= 2.0 - cfg.convex_volume_ratio:
        faults.append(
            f"encloses {ratio:.4g} of its convex hull's volume, expected {cfg.convex_volume_ratio:g}"
        )
    if len(hull.vertices) > cfg.max_hull_vertices:
        faults.append(f"has {len(hull.vertices)} vertices, allowed are {cfg.max_hull_vertices}")
    polygons = count_polygons(hull)
    if polygons > cfg.max_hull_polygons:
        faults.append(f"has {polygons} flat faces, allowed are {cfg.max_hull_polygons}")
    thickness, longest = hull_width(hull)[0], hull_length(hull)[0]
    if thickness < cfg.min_thickness - _FILE_PRECISION:
        faults.append(f"is {1e3 * thickness:.3g} mm thin, allowed is {1e3 * cfg.min_thickness:g} mm")
    elif shape.kind != "box" and longest > cfg.max_aspect * thickness * (1.0 + 1e-6):
        faults.append(f"is {longest / thickness:.4g} times as long as thick, allowed is {cfg.max_aspect:g}")
    return faults


def _volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    centered = vertices - vertices.mean(axis=0)
    return float(np.einsum("fi,fi->", area_normals(centered[faces]), centered[faces[:, 0]]) / 6.0)


def carrier(subject: Subject, link: str) -> str | None:
    """The nearest ancestor with collision geometry, skipping the intermediate link of a screw."""
    return next((name for name in subject.ancestors(link) if subject.hull_sets[name].hulls), None)


def has_carried_links(subject: Subject) -> str:
    """Applies if a link with geometry is attached to another one."""
    if any(carrier(subject, name) for name in subject.links if subject.hull_sets[name].hulls):
        return ""
    return "no link with collision geometry hangs from another one"


def check_attached(subject: Subject, cfg: CheckConfig) -> Finding:
    """V104: at rest every link is within a small distance of its carrier."""
    gaps = {}
    for name, hulls in subject.hull_sets.items():
        parent = carrier(subject, name)
        if hulls.hulls and parent is not None:
            gaps[name] = rest_gap(hulls, subject.hull_sets[parent], cfg.max_gap, subject.diagonal)
    where = max(gaps, key=lambda name: gaps[name])
    apart = [name for name, gap in gaps.items() if gap > cfg.max_gap + _FILE_PRECISION]
    return Finding(
        passed=not apart,
        value=gaps[where],
        threshold=cfg.max_gap,
        unit="m",
        where=where,
        message=f"link {where!r} is {1e3 * max(gaps[where], 0.0):.3g} mm from {carrier(subject, where)!r}, "
        f"allowed is {1e3 * cfg.max_gap:g} mm",
        links=tuple(sorted(apart)),
    )


def rest_gap(first: HullSet, second: HullSet, near: float, far: float) -> float:
    """Distance of two hull sets at rest (m), 0 where they overlap; only the nearest pairs are measured."""
    still = np.eye(4)
    for reach in (near, 10.0 * near, far):
        found = signed_distances(first, second, still, still, max_distance=reach)
        if len(found.distance):
            return max(0.0, float(found.distance.min()))
    return far


def check_floor(subject: Subject, cfg: CheckConfig) -> Finding:
    """V105: collision geometry and visual geometry reach down equally far."""
    if not subject.visuals:
        raise PackageError("no link has a visual mesh to compare the collision geometry with")
    seen = min((float(s.vertices[:, 2].min()), s.link) for s in subject.visuals if len(s.vertices))
    felt = min(float(h.vertices[:, 2].min()) for h in subject.hull_sets.values() if h.hulls)
    gap = abs(felt - seen[0])
    message = (
        f"the lowest collision point is {1e3 * (felt - seen[0]):+.3g} mm from the lowest visual one, "
        f"allowed is {1e3 * cfg.max_floor_gap:g} mm"
    )
    return at_most(gap, cfg.max_floor_gap, "m", where=seen[1], message=message, links=seen[1:])


def check_islands(subject: Subject, cfg: CheckConfig) -> Finding:
    """V107: the visual of a link is in one piece, and each of its hulls touches the visual or other hulls.

    The root, which is fixed to the world, may have posts that stand on the floor by themselves.
    """
    gaps = [(0.0, "", "every link is of one piece")]
    floor = subject.bounds[0, 2] + cfg.max_island
    for link in subject.links:
        rests = -np.inf if link in subject.parents else floor
        shown = [shape.triangles for shape in subject.visuals if shape.link == link]
        triangles = np.concatenate([np.zeros((0, 3, 3)), *shown])
        for gap, size in visual_islands(triangles, cfg.max_island, rests):
            said = f"a visible piece of {size} faces is {1e3 * gap:.3g} mm from the rest of link {link!r}"
            gaps.append((gap, link, said))
        for gap, size in hull_islands(subject.hull_sets[link], triangles, cfg.max_island):
            said = f"{size} hulls of link {link!r} are {1e3 * gap:.3g} mm from all else of it"
            gaps.append((gap, link, said))
    gap, where, said = max(gaps)
    message = f"{said}, allowed is {1e3 * cfg.max_island:g} mm"
    apart = [link for far, link, _ in gaps if far > cfg.max_island]
    return at_most(gap, cfg.max_island, "m", where=where, message=message, links=apart)


def has_texture(subject: Subject) -> str:
    """Applies if a mesh that we made has a texture."""
    reason = own_visuals(subject)
    if reason or any(_image_of(subject, shape) for shape in subject.visuals):
        return reason
    return "no visual mesh has a texture"


def check_texture(subject: Subject, cfg: CheckConfig) -> Finding:
    """V106: every face is mapped to an area of the texture that is not black, outside and inside."""
    shares = {}
    images: dict[str, np.ndarray] = {}
    for shape in subject.visuals:
        image = _image_of(subject, shape)
        if not image:
            continue
        if image not in images:
            images[image] = read_image(subject.folder / image)
        shares[shape.file] = _shown(shape, images[image])
    where = min(shares, key=lambda name: shares[name])
    message = (
        f"{where}: {100 * shares[where]:.4g} % of the area shows a color of the texture, "
        f"at least {100 * cfg.min_texture_coverage:g} % must"
    )
    low = [shape.link for shape in subject.visuals if shares.get(shape.file, 1.0) < cfg.min_texture_coverage]
    return at_least(
        shares[where], cfg.min_texture_coverage, "of the area", where=where, message=message, links=low
    )


def _image_of(subject: Subject, shape: Shape) -> str:
    """The image that a visual mesh uses, relative to the folder, or ""."""
    if not shape.obj.libraries or not len(shape.faces):
        return ""
    folder = PurePosixPath(shape.file).parent
    materials = parse_mtl(subject.folder / folder / shape.obj.libraries[-1])
    material = materials.get(shape.obj.face_materials[0])
    return str(folder / material.image) if material is not None and material.image else ""


def _shown(shape: Shape, image: np.ndarray) -> float:
    """Share of the surface with non-degenerate texture coordinates and a colour that is not black."""
    faces = shape.obj.uv_faces
    area = triangle_areas(shape.triangles)
    placed = (faces >= 0).all(axis=1)
    uv = np.zeros((len(faces), 3, 2))
    uv[placed] = shape.obj.coords[faces[placed]]
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    placed &= np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) > 1e-12
    height, width = image.shape[:2]
    at = np.einsum("sc,fcd->fsd", _SPOTS, uv)
    column = np.floor(at[..., 0] * width).astype(np.int64) % width
    row = np.floor((1.0 - at[..., 1]) * height).astype(np.int64) % height
    lit = (image[row, column, :3] > 0).any(axis=2).mean(axis=1)
    return float((area * placed * lit).sum() / max(area.sum(), 1e-12))


GEOMETRY_CHECKS = (
    CheckSpec(id="V101", level="L1", title="visual meshes", applies=own_visuals, function=check_visuals),
    CheckSpec(id="V102", level="L1", title="hulls", applies=always, function=check_hulls),
    CheckSpec(
        id="V104", level="L1", title="nothing detached", applies=has_carried_links, function=check_attached
    ),
    CheckSpec(id="V105", level="L1", title="feet on the floor", applies=has_collision, function=check_floor),
    CheckSpec(id="V106", level="L1", title="texture", applies=has_texture, function=check_texture),
    CheckSpec(id="V107", level="L1", title="no islands", applies=always, function=check_islands),
)
