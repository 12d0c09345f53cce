"""Both sides of every threshold of the static checks: just within it a package passes, just beyond it fails.

The packages are a few boxes. A cell is one of the grid of V103: 1/128 of the longest edge.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from cabinet_files import box_visual, join, joint, link, urdf
from PIL import Image

from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import run_check
from sim_export.checks.subject import Subject
from sim_export.checks.suite import CHECKS
from sim_export.checks.sweep import joint_motion, joint_poses
from sim_export.geometry.hulls import convex_hull

SPECS = {spec.id: spec for spec in CHECKS}
TURN = 2.0 * np.pi
BODY = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
CELL = 1.0 / 128.0
Box = tuple[object, object]


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A folder to judge: its URDF, and other files by name, texts or pictures."""

    urdf: str
    files: Mapping[str, str | np.ndarray]


def scene(
    *elements: str, visual: str = "voxels", category: str = "Thing", **files: str | np.ndarray
) -> Scene:
    """A package of links and joints; ``_`` in the name of a file stands for a dot."""
    meta = f'{{"format": "artigen", "visual": "{visual}", "model_cat": "{category}"}}'
    named = {name.replace("_", "."): content for name, content in files.items()}
    return Scene(urdf=urdf(*elements), files={"annotations.json": "{}", "meta.json": meta, **named})


def write(content: Scene, folder: Path) -> Subject:
    """The folder on disk."""
    (folder / "mobility.urdf").write_text(content.urdf)
    for name, data in content.files.items():
        if isinstance(data, str):
            (folder / name).write_text(data)
        else:
            Image.fromarray(data).save(folder / name)
    return Subject(folder)


def seen(box: Box, name: str = "body", about: object = (0, 0, 0)) -> str:
    """A visual from a lowest to a highest corner, in a frame at ``about``."""
    low, high = np.array(box, dtype=float)
    return box_visual(high - low, (low + high) / 2.0 - about, name)


def felt(box: Box, about: object = (0, 0, 0)) -> str:
    """A collision shape like that."""
    return seen(box, about=about).replace("visual", "collision")


def both(box: Box, about: object = (0, 0, 0)) -> str:
    """The same, seen and felt."""
    return seen(box, about=about) + felt(box, about)


def weight(
    mass: float = 1.0, com: object = (0, 0, 0), moments: tuple[float, float, float] = (1, 1, 1)
) -> str:
    """Mass properties."""
    xx, yy, zz = moments
    return (
        f'<inertial><origin xyz="{join(com)}"/><mass value="{mass}"/>'
        f'<inertia ixx="{xx:.12g}" iyy="{yy:.12g}" izz="{zz:.12g}" ixy="0" ixz="0" iyz="0"/></inertial>'
    )


def moving(
    kind: str, part: str, upper: float, *, body: str = both(BODY), lower: float = 0.0, label: str = "drawer",
    axis: object = (-1, 0, 0), about: object = (0, 0, 0),
) -> Scene:  # fmt: skip
    """A body and a part that moves."""
    return scene(
        link("body", body),
        link("part", part),
        joint(kind, "body", "part", xyz=about, axis=axis, limits=(lower, upper)),
        semantics_txt=f"body static body\npart moving {label}\n",
    )


def obj(vertices: np.ndarray, faces: np.ndarray) -> str:
    """An OBJ of triangles."""
    rows = [f"v {x:.12g} {y:.12g} {z:.12g}" for x, y, z in vertices.tolist()]
    return "\n".join([*rows, *(f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist())]) + "\n"


def shown(text: str) -> Scene:
    """What is seen, from a file."""
    return scene(link("body", '<visual><geometry><mesh filename="a.obj"/></geometry></visual>'), a_obj=text)


def hull(points: np.ndarray) -> Scene:
    """The convex hull of points as the only collision."""
    found = convex_hull(points)
    return solid(found.vertices, found.faces)


def solid(vertices: np.ndarray, faces: np.ndarray) -> Scene:
    """A mesh as the only collision."""
    shape = '<collision><geometry><mesh filename="a.obj"/></geometry></collision>'
    return scene(link("body", shape), a_obj=obj(vertices, faces))


def corners(x: float, y: float, z: float) -> np.ndarray:
    """Those of a box, turned a little, so that it is none of URDF's."""
    signs = np.stack(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5]), axis=-1).reshape(-1, 3)
    turn = np.array([[np.cos(0.3), -np.sin(0.3), 0.0], [np.sin(0.3), np.cos(0.3), 0.0], [0.0, 0.0, 1.0]])
    return signs * [x, y, z] @ turn.T


def ring(sides: int, height: float = 0.0, radius: float = 0.1) -> np.ndarray:
    """Corners of a regular polygon."""
    turn = TURN * np.arange(sides) / sides
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(sides, height)], axis=1)


def double_cone(sides: int) -> tuple[np.ndarray, np.ndarray]:
    """Two pyramids on one base: a closed surface of twice as many triangles as it has sides."""
    here = np.arange(sides)
    there = np.roll(here, -1)
    up = np.stack([here, there, np.full(sides, sides)], axis=1)
    down = np.stack([there, here, np.full(sides, sides + 1)], axis=1)
    vertices = np.concatenate([ring(sides, radius=1.0), [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    return vertices, np.concatenate([up, down])


def with_faces(count: int) -> Scene:
    """A double cone; where the number of faces is odd, one is a line."""
    points, faces = double_cone(count // 2)
    vertices, number = np.unique(points.round(9), axis=0, return_inverse=True)
    return shown(obj(vertices, number.ravel()[faces]) + "f 1 2 1\n" * (count % 2))


def with_slivers(sides: int) -> Scene:
    """A double cone and a plate with eight faces that are as good as lines."""
    vertices, faces = double_cone(sides)
    plate = convex_hull(corners(1.0, 1.0, 1e-5))
    return shown(obj(np.concatenate([vertices, plate.vertices + 3.0]),
                     np.concatenate([faces, plate.faces + len(vertices)])))  # fmt: skip


def dented(depth: float) -> Scene:
    """A cube of one metre with a pyramid of this depth cut out of its top: a third of that of its volume."""
    cube = convex_hull(np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float))
    top = (cube.vertices[cube.faces][:, :, 2] == 1.0).all(axis=1)
    rim = [0, 1, 2, 3]
    at = np.array([[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1], [0.5, 0.5, 1 - depth]], dtype=float)
    kept, own = cube.vertices[cube.faces][~top].reshape(-1, 3), at[[[k, (k + 1) % 4, 4] for k in rim]]
    vertices, faces = np.unique(np.concatenate([kept, own.reshape(-1, 3)]), axis=0, return_inverse=True)
    return solid(vertices, faces.reshape(-1, 3))


def pyramid(polygons: int) -> np.ndarray:
    """64 vertices with 64 flat faces, or 65: a pyramid, with a corner more above one of its sides."""
    sides = 63 if polygons == 64 else 62
    base, top = ring(sides), np.array([[0.0, 0.0, 0.1]])
    peak = 1.0005 * np.concatenate([base[:2], top]).mean(axis=0, keepdims=True)
    return np.concatenate([base, top, *([] if polygons == 64 else [peak])])


def prism(vertices: int) -> np.ndarray:
    """A prism of 64 vertices; with a corner more before one of its sides."""
    walls = np.concatenate([ring(32), ring(32, 0.1)])
    return np.concatenate([walls, 1.0005 * walls[[0, 1, 32, 33]].mean(axis=0, keepdims=True)])[:vertices]


def standing_out(share: float, width: float) -> Scene:
    """A plate on a cube, seen but not felt, that is as high as this share of the diagonal."""
    height = 0.0
    for _ in range(30):
        height = share * np.sqrt(2.0 + (1.0 + height) ** 2)
    low = (1.0 - width) / 2.0
    plate = ((low, low, 1.0), (low + width, low + width, 1.0 + height))
    return scene(link("body", both(BODY), seen(plate)))


def standing_out_of_little(height: float) -> Scene:
    """A plate on a cube of 2 cm, seen but not felt, and so high (m)."""
    plate = ((0.0095, 0.0095, 0.02), (0.0105, 0.0105, 0.02 + height))
    return scene(link("body", both(((0.0, 0.0, 0.0), (0.02, 0.02, 0.02))), seen(plate)))


def thin(cells: tuple[float, float]) -> Scene:
    """A plate of one metre that is seen as thick as the first of these, and felt as thick as the second."""
    looks, feels = (((0.0, 0.0, 0.0), (1.0, 1.0, count * CELL)) for count in cells)
    return scene(link("body", seen(looks), felt(feels)))


def tray(inside: Box, size: float = 1.0, *fill: Box) -> Scene:
    """A block with a hollow, open at the top, in cells; what fills some of that is only felt."""
    low, high = np.array(inside, dtype=float)
    top = high[2]
    walls = [
        ((0, 0, 0), (128, 128, low[2])),
        ((0, 0, low[2]), (low[0], 128, top)),
        ((high[0], 0, low[2]), (128, 128, top)),
        ((low[0], 0, low[2]), (high[0], low[1], top)),
        ((low[0], high[1], low[2]), (high[0], 128, top)),
    ]
    scaled = [tuple(size * CELL * np.array(box, dtype=float)) for box in (*walls, *fill)]
    return scene(link("body", *(both(box) for box in scaled[:5]), *(felt(box) for box in scaled[5:])))


def filled_share(share: float) -> Scene:
    """A hollow 16 cells deep; two of them are filled over a part of its floor."""
    inside = ((4, 4, 24), (124, 124, 40))
    return tray(inside, 1.0, ((4, 4, 24), (4 + 120 * 8 * share, 124, 26)))


def groove(width: int, size: float) -> Scene:
    """A groove of so many cells across and deep, filled where it is felt."""
    inside = ((4, 4, 24), (124, 4 + width, 24 + width))
    return tray(inside, size, inside)


def halves(gap: float) -> Scene:
    """The shell of a wheel with a hole, felt as two solid halves with a gap between them."""
    wall, low, high = 0.02, 0.485, 0.515
    plates = [
        ((0, 0, 0), (1, 1, wall)), ((0, 0, 1 - wall), (1, 1, 1)), ((0, 0, wall), (1, wall, 1 - wall)),
        ((0, 1 - wall, wall), (1, 1, 1 - wall)), ((1 - wall, wall, wall), (1, 1 - wall, 1 - wall)),
        ((0, wall, wall), (wall, low, 1 - wall)), ((0, high, wall), (wall, 1 - wall, 1 - wall)),
        ((0, low, wall), (wall, high, low)), ((0, low, high), (wall, high, 1 - wall)),
    ]  # fmt: skip
    solids = felt(((0, 0, 0), (1, 1, 0.5 - gap))) + felt(((0, 0, 0.5), (1, 1, 1)))
    shell = link("body", *map(seen, plates), solids)
    return scene(shell, visual="source", semantics_txt="body hinge wheel\n")


def textured(bare: int) -> Scene:
    """A thousand triangles, some of which have no place on the texture."""
    corners_of = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.2 0.2\nvt 0.8 0.2\nvt 0.2 0.8\nvt 0.2 0.2\n"
    faces = ["f 1/1 2/2 3/3"] * (1000 - bare) + ["f 1/1 2/4 3/3"] * bare
    text = "mtllib a.mtl\n" + corners_of + "usemtl a\n" + "\n".join(faces) + "\n"
    content = shown(text)
    files = {"a.mtl": "newmtl a\nmap_Kd a.png\n", "a.png": np.full((4, 4, 3), 200, dtype=np.uint8)}
    return Scene(urdf=content.urdf, files={**content.files, **files})


def slide(part: Box, upper: float = 0.5, lower: float = 0.0, axis: float = 1.0) -> Scene:
    """Something before the body that slides towards it, along an axis of this length."""
    return moving("prismatic", both(part), upper, lower=lower, axis=(axis, 0, 0))


def bump(share: float) -> Scene:
    """A drawer whose front is blocked ahead over this share, and free behind it."""
    front = ((-0.02, 0.0, 0.0), (0.0, 1.0, 1.0))
    return moving("prismatic", both(front), 0.3, body=both(((-0.2, 0.0, 0.4), (-0.1, 1.0, 0.4 + share))))


def swing(reach: float) -> Scene:
    """A door, and before it something that its edge would meet after this turn (rad), if it went straight."""
    post = ((-reach - 0.1, -1.0, 0.0), (-reach, -0.8, 1.0))
    door = ((-0.01, -1.0, 0.0), (0.0, 0.0, 1.0))
    return moving("revolute", both(door), 1.5, body=both(post), axis=(0, 0, -1), label="door")


def hinged(at: float, tilt: float = 90.0, thickness: float = 0.01) -> Scene:
    """A door of a metre that turns about a line this far from its edge, so tilted out of its normal."""
    door = ((-thickness, -1.0, 0.0), (0.0, 0.0, 1.0))
    axis = (-np.cos(np.radians(tilt)), 0.0, np.sin(np.radians(tilt)))
    about = (-thickness / 2.0, -at, 0.5)
    far = both(((5.0, 5.0, 0.0), (6.0, 6.0, 1.0)))
    return moving("revolute", both(door, about), 1.5, body=far, axis=axis, about=about, label="door")


def leaves(size: float = 1.0, tilt: float = 0.0, axes: tuple[float, float] = (1.0, 1.0)) -> Scene:
    """Two doors side by side that open to one side; the second is higher, or its axis tilted (degrees)."""
    doors = (((0.0, 0.0, 0.0), (0.02, 0.5, 1.0)), ((0.0, 0.5, 0.0), (0.02, 1.0, size)))
    turned = np.radians(tilt)
    rows = [link("body")]
    for index, (door, hinge, sign) in enumerate(zip(doors, (0.0, 1.0), axes, strict=True)):
        axis = sign * np.array([np.sin(turned) * index, 0.0, np.cos(turned * index)])
        rows.append(link(f"door_{index}", both(door, (0.0, hinge, 0.0))))
        rows.append(joint("revolute", "body", f"door_{index}", xyz=(0, hinge, 0), axis=axis, limits=(0, 1)))
    return scene(*rows, semantics_txt="door_0 hinge door\ndoor_1 hinge door\n")


def drawer(held: float) -> Scene:
    """A drawer one metre deep of which this share stays in the body."""
    part = ((0.0, 0.1, 0.1), (1.0, 0.9, 0.9))
    walls = both(((0.0, 0.0, 0.0), (1.0, 1.0, 0.1)))
    return moving("prismatic", both(part), 1.0 - held, body=walls)


def handle(gap: float = 0.0, width: float = 0.05, depth: float = 0.02, height: float | None = None) -> Scene:
    """A drawer's front with a handle: its distance from the front, its size across (by default a square) and
    its depth (m)."""
    front = ((-0.02, 0.0, 0.0), (0.0, 1.0, 1.0))
    half, rise = width / 2.0, (height or width) / 2.0
    grip = ((-0.02 - gap - depth, 0.5 - half, 0.5 - rise), (-0.02 - gap, 0.5 + half, 0.5 + rise))
    return moving("prismatic", both(front) + seen(grip, "handle"), 0.3)


def grasped(gap: float) -> Scene:
    """A grasp of a bar 20 mm thick, both pads so far (m) from it."""
    bar = ((-0.4, 0.0, -0.01), (0.0, 0.3, 0.01))
    grasp = {"link": "part", "part": "bar", "joint": "", "gripper": "franka", "position": [-0.2, 0.1, 0.0],
             "quaternion": [0.5**0.5, 0.5**0.5, 0.0, 0.0], "width": 0.02 + 2.0 * gap, "score": 1.0,
             "proofs": []}  # fmt: skip
    notes = json.dumps({"grasps": {"version": 1, "grasps": [grasp]}})
    return scene(link("part", both(bar)), annotations_json=notes)


def beside(gap: float) -> Scene:
    """A part beside the body."""
    return slide(((-0.1 - gap, 0.0, 0.0), (-gap, 1.0, 1.0)))


def into(depth: float, height: float, thickness: float = 0.1) -> Scene:
    """A board that slides into the body with its narrow end, or with less of it than that."""
    part = ((-0.3 - thickness, 0.0, 1.0 - height), (-0.3, 1.0, 2.0 - height))
    return slide(part, 0.3 + depth)


def overlap(depth: float, *, related: bool) -> Scene:
    """A part in the body that carries it, or in another that stands still."""
    part = ((-0.2, 0.0, 0.0), (depth, 1.0, 1.0))
    if related:
        return slide(part)
    content = [link("body", both(BODY)), link("part", both(part)), link("root")]
    joints = [joint("prismatic", "root", "part", limits=(0, 1)), joint("fixed", "root", "body")]
    return scene(*content, *joints)


def links(count: int, shapes: int = 1, others: int = 0) -> Scene:
    """So many links, the first with so many shapes and two others with the rest of them."""
    rows = [link("link_0", felt(BODY) * shapes)]
    for index in range(1, count):
        rows += [link(f"link_{index}", felt(BODY) * (others if index < 3 else 0))]
        rows += [joint("fixed", "link_0", f"link_{index}")]
    return scene(*rows)


def cube(edge: float, category: str = "Thing") -> Scene:
    """A cube with this diagonal."""
    side = edge / np.sqrt(3.0)
    return scene(link("body", seen(((0, 0, 0), (side, side, side)))), category=category)


def heavy(**given: object) -> Scene:
    """A cube of one metre with mass properties."""
    return scene(link("body", both(BODY), weight(**{"com": (0.5, 0.5, 0.5), **given})))


FRONT = ((-0.1, 0.0, 0.0), (0.0, 1.0, 1.0))
ROWS: list[tuple[str, str, Callable[..., Scene], object, object]] = [
    ("axis", "V005", lambda x: slide(FRONT, axis=x), 1 + 0.9e-6, 1 + 1.1e-6),
    ("rest", "V005", lambda x: slide(FRONT, lower=x), 0.9e-6, 1.1e-6),
    ("turn", "V005", lambda x: moving("revolute", both(FRONT), x), TURN + 0.9e-3, TURN + 1.1e-3),
    ("links", "V006", links, 64, 65),
    ("hulls on a link", "V006", lambda x: links(1, x), 96, 97),
    ("hulls", "V006", lambda x: links(3, x, 90), 76, 77),
    ("least mass", "V007", lambda x: heavy(mass=x), 0.0101, 0.0099),
    ("least mass of a small cube", "V007", lambda x: scene(
        link("body", both(((0, 0, 0), (x, x, x))), weight(mass=0.002, com=(0.1, 0.1, 0.1)))), 0.299, 0.301),
    ("largest mass", "V007", lambda x: heavy(mass=x), 499, 501),
    ("inertia", "V008", lambda x: heavy(moments=(1, 1, x)), 2 + 1.8e-6, 2 + 2.2e-6),
    ("centre", "V008", lambda x: heavy(com=(0.5, 0.5, 1.0 + x)), 0.9e-3, 1.1e-3),
    ("smallest thing", "V009", cube, 0.101, 0.099),
    ("largest thing", "V009", cube, 2.99, 3.01),
    ("smallest switch", "V009", lambda x: cube(x, "Switch"), 0.051, 0.049),
    ("largest switch", "V009", lambda x: cube(x, "Switch"), 0.59, 0.61),
    ("faces", "V101", with_faces, 50_000, 50_001),
    ("sliver", "V101", lambda x: scene(link("body", seen(((0, 0, 0), (1, 1, x))))), 1.05e-4, 0.95e-4),
    ("slivers", "V101", with_slivers, 345, 344),
    ("convex", "V102", dented, 0.0027, 0.0033),
    ("hull vertices", "V102", lambda x: hull(prism(x)), 64, 65),
    ("hull polygons", "V102", lambda x: hull(pyramid(x)), 64, 65),
    ("aspect", "V102", lambda x: hull(corners(0.02, 0.02 * x, 0.02)), 63.9, 64.1),
    ("thickness", "V102", lambda x: hull(corners(0.02, 0.02, x)), 1e-3 - 1.9e-6, 1e-3 - 2.1e-6),
    ("farthest", "V103", lambda x: standing_out(x, 0.15), 0.0298, 0.0302),
    ("farthest, of little", "V103", standing_out_of_little, 2.98e-3, 3.02e-3),
    ("99 %", "V103", lambda x: standing_out(x, 0.5), 0.0149, 0.0151),
    ("volumes", "V103", thin, (14.46, 12.40), (12.55, 11.40)),
    ("room kept", "V103", filled_share, 0.098, 0.102),
    ("cavity", "V103", lambda x: groove(x, 1.0), 4, 5),
    ("cavity of a small thing", "V103", lambda x: groove(x, 0.5), 7, 8),
    ("cavity in cells", "V103", lambda x: groove(x, 2.9), 2, 3),
    ("covered", "V103", halves, 0.9e-3, 1.1e-3),
    ("gap", "V104", beside, 0.005 + 1e-6, 0.005 + 3e-6),
    ("floor", "V105", lambda x: scene(link("body", seen(BODY), felt(((0, 0, x), (1, 1, 1))))),
     4.9e-3, 5.1e-3),
    ("texture", "V106", textured, 9, 11),
    ("island", "V107", lambda x: scene(link("body", both(BODY), seen(((1 + x, 0, 0.1), (2, 1, 1))))),
     4.9e-3, 5.1e-3),
    ("depth on the way", "V201", lambda x: into(x, 0.05), 1.9e-3, 2.1e-3),
    ("volume on the way", "V201", lambda x: into(0.1 * x, 1.0), 0.0092, 0.0108),
    ("touch on the way", "V201", lambda x: into(x, 1.0, 0.005), 0.9e-4, 1.1e-4),
    ("at rest", "V202", lambda x: overlap(x, related=False), 0.9e-3, 1.1e-3),
    ("at rest in its carrier", "V202", lambda x: overlap(x, related=True), 1.9e-3, 2.1e-3),
    ("blocked", "V203", bump, 0.016, 0.027),
    ("first turn", "V203", swing, 1.05, 0.95),
    ("hinge", "V203", hinged, 0.049, 0.051),
    ("hinge of a thick door", "V203", lambda x: hinged(x, thickness=0.3), 0.149, 0.151),
    ("lid", "V203", lambda x: hinged(0.5, x), 59.0, 61.0),
    ("clearance", "V204", lambda x: handle(gap=x, width=0.1), 0.0252, 0.0248),
    ("grasp", "V204", lambda x: handle(width=x), 0.0798, 0.0802),
    ("protrusion", "V204", lambda x: handle(depth=x), 0.0051, 0.0049),
    ("protrusion of a lip", "V204", lambda x: handle(depth=x, width=0.3, height=0.002), 0.0051, 0.0049),
    ("twins of one size", "V205", lambda x: leaves(size=1 + x), 0.054, 0.052),
    ("twins with parallel hinges", "V205", lambda x: leaves(tilt=x), 5.1, 4.9),
    ("twins", "V205", lambda x: leaves(axes=(1.0, x)), -1.0, 1.0),
    ("held", "V206", drawer, 0.101, 0.099),
    ("grasp on its handle", "V207", grasped, 2.9e-3, 3.1e-3),
]  # fmt: skip


@pytest.mark.parametrize(("check", "build", "within", "beyond"), [
    pytest.param(*row[1:], id=row[0].replace(" ", "-")) for row in ROWS
])  # fmt: skip
def test_what_is_within_passes_and_what_is_beyond_fails(
    tmp_path: Path, check: str, build: Callable[..., Scene], within: object, beyond: object
):
    found = {}
    for side, value in (("within", within), ("beyond", beyond)):
        (tmp_path / side).mkdir()
        found[side] = run_check(SPECS[check], write(build(value), tmp_path / side), CheckConfig())
    assert found["within"].verdict != "fail", found["within"].message
    assert found["beyond"].verdict == "fail", found["beyond"].message
    assert found["beyond"].value is not None, found["beyond"].message


@pytest.mark.parametrize(("label", "verdict"), [("base", "fail"), ("wheel", "pass")])
def test_the_inside_of_a_wheel_may_be_full_so_that_it_rolls(tmp_path, label, verdict):
    content = groove(5, 1.0)
    named = Scene(urdf=content.urdf, files={**content.files, "semantics.txt": f"body hinge {label}\n"})
    assert run_check(SPECS["V103"], write(named, tmp_path), CheckConfig()).verdict == verdict


def sunk(travel: float) -> Scene:
    """A block, and a button that is drawn 10 cm into it, for which its hulls leave a pit; it slides out."""
    floor = felt(((0.0, 0.0, 0.0), (1.0, 1.0, 0.9)))
    sides = [((0.0, 0.0, 0.9), (0.4, 1.0, 1.0)), ((0.6, 0.0, 0.9), (1.0, 1.0, 1.0))]
    sides += [((0.4, 0.0, 0.9), (0.6, 0.4, 1.0)), ((0.4, 0.6, 0.9), (0.6, 1.0, 1.0))]
    body = seen(BODY) + floor + "".join(map(felt, sides))
    button = both(((0.4, 0.4, 0.9), (0.6, 0.6, 1.05)))
    return moving("prismatic", button, travel, body=body, label="knob", axis=(0, 0, 1))


def pinned(travel: float) -> Scene:
    """A plate on a block, with a pin 30 cm deep in it that no hull stands for; it moves up."""
    plate = both(((0.3, 0.3, 1.002), (0.7, 0.7, 1.1))) + seen(((0.45, 0.45, 0.7), (0.55, 0.55, 1.002)))
    return moving("prismatic", plate, travel, label="knob", axis=(0, 0, 1))


@pytest.mark.parametrize(
    ("make", "travel", "verdict"),
    [
        (sunk, 0.0, "pass"),
        (sunk, 0.09, "pass"),
        (sunk, 0.11, "fail"),
        (pinned, 0.0, "pass"),
        (pinned, 0.05, "pass"),
        (pinned, 0.06, "fail"),
    ],
)
def test_what_a_link_holds_wherever_another_moves_counts_for_nothing(tmp_path, make, travel, verdict):
    """The top of a block, 10 cm from any hull where a button is drawn into it; a pin, all but what comes out,
    of which 5.4 cm may be far from any hull."""
    content = make(travel)
    source = Scene(urdf=content.urdf, files={**content.files, "meta.json": '{"visual": "source"}'})
    assert run_check(SPECS["V103"], write(source, tmp_path), CheckConfig()).verdict == verdict


@pytest.mark.parametrize(("upper", "poses"), [(0.01, 21), (0.3, 61), (3.0, 401)])
def test_no_point_jumps_over_a_thin_thing_unless_there_are_too_many_poses(tmp_path, upper, poses):
    """Steps of 5 mm, at least 20 and at most 400 of them."""
    subject = write(slide(FRONT, upper), tmp_path)
    T = joint_motion(subject, subject.driven[0], CheckConfig()).T["part"]
    assert len(T) == poses


def test_poses_of_all_joints_are_balanced(tmp_path):
    """64 are a power of two: every 64th part of every joint's range has one."""
    subject = write(slide(FRONT, 0.64), tmp_path)
    at = joint_poses(subject, CheckConfig()).T["part"][:, 0, 3]
    assert sorted(np.floor(at / 0.01 + 1e-9).astype(int)) == list(range(64))


@pytest.mark.parametrize(("width", "named"), [(0.5, "body, lid"), (0.1, "body")])
def test_v103_names_all_links_with_much_of_the_surface_that_is_far_off(tmp_path, width, named):
    """Plates 0.2 m beside two cubes, that of the lid ``width`` wide."""
    plates = [
        ((0.25, 0.25, z), (0.25 + side, 0.25 + side, z + 0.2)) for z, side in ((1.0, 0.5), (4.0, width))
    ]
    lid = ((0.0, 0.0, 3.0), (1.0, 1.0, 4.0))
    content = scene(
        link("body", both(BODY), seen(plates[0])),
        link("lid", both(lid), seen(plates[1])),
        joint("fixed", "body", "lid"),
    )
    found = run_check(SPECS["V103"], write(content, tmp_path), CheckConfig())
    assert found.verdict == "fail"
    assert found.where == named
