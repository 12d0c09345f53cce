"""Rendered views for the reader: procedural objects, alone or in rooms, with a mark for every part.

A view is a picture with the number of the part that each pixel shows. Its marks say what a part is and where
its corners are in the picture; `artigen.examples.reader_pictures` turns a view into training pictures.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, UInt8, UInt16

from artigen.camera import Camera, frame_points, project_points
from artigen.examples.mesh_pictures import pack_picture
from artigen.examples.photographs import find_direction
from artigen.examples.reader_rooms import SURROUNDINGS, arrange_shapes, furnish_room, join_shapes
from artigen.kind import Trade, kinds
from artigen.kinematics import joint_coordinates
from artigen.reader.labels import DIAL, FRONT, HINGES, KINDS, MATERIALS, PULL, SHELF, UNKNOWN, WHEEL
from artigen.shapes.draw import CrowdedError, draw_shape
from artigen.shapes.poses import place_posed, pose_parts
from artigen.shapes.primitives import place_vertices
from artigen.shapes.render import RenderConfig, batch_cameras, build_scene, render
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish, FinishKind
from artigen.types import FIXED

EDGE = 384
"""Pixels of a view's edge."""
NOTHING = 65535
"""Number of a pixel that shows no part."""
THING_OF = {
    "door": FRONT, "drawer": FRONT, "handle": PULL, "knob": DIAL, "shelf": SHELF, "tray": SHELF,
    "wheel": WHEEL,
}  # fmt: skip
NEAR, FAR = (0.6, 0.3), (0.95, 0.75)
"""Largest yaw to either side and largest pitch (radians) of two thirds of the cameras, and of the others."""
OPEN, AJAR = 0.25, 0.04
"""Share of objects with open parts; share of its range from which a part counts as open."""
ROOMS = 0.45
"""Share of the views that show a room."""
RESTYLED = 0.4
"""Share of the objects whose finishes are drawn anew, regardless of what suits the kind."""
LEG = 0.05
"""Height (m) under the lowest wide solid from which an object stands on legs."""
PART = np.dtype(
    [
        ("thing", np.int8),
        ("object", np.int8),
        ("door", np.int8),
        ("hinge", np.int8),
        ("open", np.int8),
        ("pane", np.int8),
        ("material", np.int8),
        ("corners", np.float32, (4, 2)),
    ]
)
"""A part of a view: what it is (`UNKNOWN` for bodies), its object, whether it is a door (1) or a drawer (0),
side of its hinges, whether it is open and glazed, its material, and the corners of its front (pixels; from
the upper left clockwise)."""
BODY = np.dtype(
    [("kind", np.int16), ("stand", np.int8), ("view", np.float32, (3,)), ("size", np.float32, (3,))]
)
"""An object of a view: kind, stand, camera (yaw, pitch, and half its diagonal over its distance), and width,
depth and height (m)."""
OFTEN: dict[Trade | None, float] = {"furniture": 3.5, "appliance": 2.0}
"""Weights of kinds by their trade; the others have 1.2."""
SELDOM = 1.2
RICH = 0.55
"""Share of the furniture that is the richest in fronts of three drawn."""
TALL = 1.0
"""Height (m) that kinds which stand beside others may have."""


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """A rendered picture with its marks."""

    rgba: UInt8[np.ndarray, "S S 4"]
    """Premultiplied on black; opaque everywhere in rooms."""
    ids: UInt16[np.ndarray, "S S"]
    parts: np.ndarray
    """Rows of `PART`."""
    bodies: np.ndarray
    """Rows of `BODY`; the first is the main object."""


def take_views(seed: int, count: int, device: str = "cpu") -> list[View]:
    """Renders ``count`` views on a device, a pure function of the seed but for rounding."""
    rng = np.random.default_rng([seed, 7])
    return [_take_view(rng, device) for _ in range(count)]


def _take_view(rng: np.random.Generator, device: str) -> View:
    weights = np.array([OFTEN.get(kinds()[name].trade, SELDOM) for name in KINDS])
    kind = KINDS[int(rng.choice(len(KINDS), p=weights / weights.sum()))]
    beside = [one.name for one in kinds().values() if one.trade in OFTEN and one.sizes[2][1] >= TALL]
    shapes = [_draw(kind, rng)]
    room = bool(rng.random() < ROOMS)
    while room and len(shapes) < 4 and rng.random() < 0.5:
        shapes.append(_draw(str(rng.choice(beside)), rng))
    poses = [_open_parts(shape, rng) for shape in shapes]
    wide, high = NEAR if rng.random() < 0.67 else FAR
    yaw, pitch = rng.uniform(-wide, wide), rng.uniform(-0.1, high)
    points = place_posed(shapes[0], poses[0])
    zoom = rng.uniform(0.8, 1.8) if room and len(shapes) > 1 else rng.uniform(0.95, 1.15)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    camera = frame_points(
        middle + zoom * (points - middle),
        find_direction(yaw, pitch),
        fov=rng.uniform(14.0, 60.0),
        width=EDGE,
        height=EDGE,
    )
    return _photograph(
        arrange_shapes(shapes, rng) if room else shapes, poses, camera, rng, room=room, device=device
    )


def _draw(kind: str, rng: np.random.Generator) -> Shape:
    """An object; often the richest in fronts of three, as real cabinets have more than the grammar's."""
    tries = 3 if kinds()[kind].trade == "furniture" and rng.random() < RICH else 1
    drawn: list[Shape] = []
    while len(drawn) < tries:
        try:
            drawn.append(draw_shape(kind, int(rng.integers(2**40))))
        except CrowdedError:
            continue
    shape = max(drawn, key=lambda one: sum(part.label in ("door", "drawer") for part in one.parts))
    if rng.random() < 0.2:
        shape = replace(
            shape, parts=tuple(p for p in shape.parts if p.label != "handle" or _carries(shape, p))
        )
    return _restyle(shape, rng) if rng.random() < RESTYLED else shape


def _carries(shape: Shape, part: ShapePart) -> bool:
    """Whether anything depends on a part."""
    return part.joint is not None or any(
        part.name in (other.parent, *(need.part for need in other.needs)) for other in shape.parts
    )


def _restyle(shape: Shape, rng: np.random.Generator) -> Shape:
    """The shape in other colours and materials; what is transparent stays so."""
    kinds: list[FinishKind] = ["wood", "lacquer", "steel", "plastic", "stone"]
    worn = []
    for name, finish in shape.finishes:
        if finish.opacity < 1.0 or finish.kind == "glass" or rng.random() < 0.35:
            worn.append((name, finish))
            continue
        value = rng.uniform(0.06, 1.0)
        color = np.clip(
            value + rng.normal(0, rng.choice([0.02, 0.07, 0.2], p=[0.4, 0.4, 0.2]), 3), 0.02, 0.98
        )
        kind = kinds[rng.choice(5, p=[0.35, 0.3, 0.12, 0.15, 0.08])]
        if kind == "wood":
            color = np.clip(
                np.array([0.75, 0.52, 0.32]) * rng.uniform(0.25, 1.25) + rng.normal(0, 0.06, 3), 0.02, 0.98
            )
        accent = np.clip(color * rng.uniform(0.45, 1.1), 0, 1)
        worn.append(
            (
                name,
                Finish(
                    kind=kind,
                    color=tuple(color.tolist()),
                    accent=tuple(accent.tolist()),
                    grain=finish.grain,
                    period=float(np.exp(rng.uniform(np.log(0.008), np.log(0.12)))),
                    seed=int(rng.integers(2**30)),
                    gloss=float(rng.uniform(0.02, 0.7)),
                ),
            )
        )
    return replace(shape, finishes=tuple(worn))


def _open_parts(shape: Shape, rng: np.random.Generator) -> Float[np.ndarray, "P"]:
    """Joint coordinates: mostly closed, or one to three parts open by any amount."""
    qpos = np.zeros(len(shape.parts))
    free = [k for k, part in enumerate(shape.parts) if part.joint is not None and not part.needs]
    if free and rng.random() < OPEN:
        for k in rng.choice(free, size=min(len(free), int(rng.integers(1, 4))), replace=False):
            motion = shape.parts[int(k)].joint
            assert motion is not None
            qpos[k] = rng.random() * min(motion.upper, 2.0)
    names = [part.name for part in shape.parts]
    own = [part.joint or FIXED for part in shape.parts]
    return np.array(joint_coordinates(names, own, dict(zip(names, qpos, strict=True))))


def _photograph(
    shapes: Sequence[Shape],
    poses: Sequence[np.ndarray],
    camera: Camera,
    rng: np.random.Generator,
    *,
    room: bool,
    device: str,
) -> View:
    """Renders shapes together, with the marks of their parts."""
    joined, owners = join_shapes(shapes)
    qpos = np.concatenate([[0.0], *poses])  # the first part is the world
    if room:
        extra, finishes = furnish_room(shapes, rng)
        joined = replace(joined, parts=(*joined.parts, *extra), finishes=(*joined.finishes, *finishes))
        owners = np.concatenate([owners, np.full(len(extra), SURROUNDINGS)])
        qpos = np.concatenate([qpos, np.zeros(len(extra))])
    soft = rng.random() < 0.25
    light = RenderConfig(
        lamp=(-rng.uniform(0.3, 1.0), rng.uniform(-0.8, 0.8), rng.uniform(0.3, 1.0)),
        lamp_strength=rng.uniform(0.2, 0.8),
        fill_strength=rng.uniform(0.2, 0.5),
        shadow_rays=int(not soft),
        openness=bool(rng.random() < 0.8),
    )
    seen = render(build_scene([joined], device), batch_cameras([camera], device), [qpos], cfg=light)
    mask = seen.mask[0].cpu().numpy()
    ids = np.where(mask, seen.part_ids[0].cpu().numpy(), NOTHING).astype(np.uint16)
    displacements = pose_parts(joined, qpos)
    parts = np.array(
        [
            _mark(joined, k, int(owners[k]), displacements[k], float(qpos[k]), camera)
            for k in range(len(joined.parts))
        ],
        dtype=PART,
    )
    bodies = np.array([_describe(shape, camera) for shape in shapes], dtype=BODY)
    return View(rgba=pack_picture(seen.rgb[0].cpu().numpy(), mask), ids=ids, parts=parts, bodies=bodies)


def _mark(
    shape: Shape, index: int, owner: int, T_world_part: np.ndarray, q: float, camera: Camera
) -> tuple[object, ...]:
    """A row of `PART`."""
    part = shape.parts[index]
    if owner == SURROUNDINGS or part.label not in THING_OF:
        return (UNKNOWN, owner, UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN, np.zeros((4, 2)))
    finishes = dict(shape.finishes)
    largest = max(part.primitives, key=lambda solid: float(np.prod(np.sort(solid.size)[1:])))
    material = MATERIALS.index(finishes[largest.finish].kind)
    if THING_OF[part.label] != FRONT:
        return (THING_OF[part.label], owner, UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN, material, np.zeros((4, 2)))
    corners, hinge = project_front(part, T_world_part, camera)
    area = float(np.prod(np.sort(np.diff(part.bounds(), axis=0)[0])[1:]))
    glazed = any(
        finishes[solid.finish].kind == "glass" and float(np.prod(np.sort(solid.size)[1:])) > 0.12 * area
        for solid in part.primitives
    )
    motion = part.joint
    swings = motion is not None and motion.type == "revolute" and part.label == "door"
    opened = motion is not None and q > AJAR * min(motion.upper, 2.0)
    return (
        FRONT,
        owner,
        int(part.label == "door"),
        hinge if swings else UNKNOWN,
        int(opened),
        int(glazed),
        material,
        corners,
    )


def project_front(
    part: ShapePart, T_world_part: Float[np.ndarray, "4 4"], camera: Camera
) -> tuple[Float[np.ndarray, "4 2"], int]:
    """Corners (pixels) of the face of a door or drawer that looks outward, from the upper left clockwise as
    seen, and the side of its hinges (index into `HINGES`)."""
    low, high = part.bounds()
    size = high - low
    normal = 0 if part.label == "drawer" else int(np.argmin(size))
    outer = high[normal] if normal == 2 else low[normal]
    a, b = [k for k in range(3) if k != normal]
    face = np.zeros((4, 3))
    face[:, normal] = outer
    for row, (u, v) in enumerate(
        ((low[a], low[b]), (low[a], high[b]), (high[a], high[b]), (high[a], low[b]))
    ):
        face[row, a], face[row, b] = u, v
    seen = project_points(camera, face @ T_world_part[:3, :3].T + T_world_part[:3, 3])[:, :2]
    corners = sort_corners(seen)
    hinge = UNKNOWN
    if part.joint is not None and part.joint.type == "revolute":
        axis, origin = part.joint.axis, part.joint.origin
        middle = face.mean(axis=0)
        foot = origin + axis * float((middle - origin) @ axis)
        ends = np.stack([middle, foot])  # the axis does not move with the part, its foot may
        there = project_points(camera, ends @ T_world_part[:3, :3].T + T_world_part[:3, 3])[:, :2]
        right, down = there[1] - there[0]
        if abs(right) > abs(down):
            hinge = HINGES.index("right" if right > 0 else "left")
        else:
            hinge = HINGES.index("bottom" if down > 0 else "top")
    return corners, hinge


def sort_corners(points: Float[np.ndarray, "4 2"]) -> Float[np.ndarray, "4 2"]:
    """Four corners in cyclic order, from the upper left clockwise in the picture."""
    middle = points.mean(axis=0)
    angles = np.arctan2(points[:, 1] - middle[1], points[:, 0] - middle[0])
    ordered = points[np.argsort(angles)]
    start = int(np.argmin(ordered.sum(axis=1)))
    return np.roll(ordered, -start, axis=0)


def _describe(shape: Shape, camera: Camera) -> tuple[object, ...]:
    """A row of `BODY`."""
    low, high = shape.bounds()
    away = camera.position - (low + high) / 2
    distance = float(np.linalg.norm(away))
    near = float(np.linalg.norm(high - low)) / 2 / distance
    view = (np.arctan2(away[1], -away[0]), np.arcsin(away[2] / distance), near)
    depth, width, height = high - low
    return KINDS.index(shape.category), _find_stand(shape), view, (width, depth, height)


def _find_stand(shape: Shape) -> int:
    """Index into `STANDS`."""
    if sum(part.label == "wheel" for part in shape.parts) >= 3:
        return 2
    low, high = shape.bounds()
    footprint = float(np.prod((high - low)[:2]))
    wide = []
    for part in shape.parts:
        for solid in part.primitives:
            points = place_vertices(solid)
            if float(np.prod(np.ptp(points[:, :2], axis=0))) > 0.25 * footprint:
                wide.append(float(points[:, 2].min()))
    return int(bool(wide) and min(wide) - low[2] > LEG)
