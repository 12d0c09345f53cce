"""A room as one MJCF: packages attached at their places, walls as boxes, loose things as free bodies.

Packages are referred to, not copied (MuJoCo's ``attach``): their bodies, joints and geoms get the id of the
placement as a prefix, ``fridge_1/joint_0``. MuJoCo starts with all joints at 0; the coordinates of the room,
in which doors may stand ajar, are the keyframe ``home``. What rests sleeps: MuJoCo leaves it out of its steps
until something touches, pushes or moves it.
"""

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false

import os
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.io import write_whole
from artigen.transforms import quat_from_matrix
from sim_export.errors import PackageError
from sim_export.files.mjcf import HULL_FRICTION, primitive_geom
from sim_export.files.urdf import format_vector, xml_text

from ..sim.mechanism import find_mechanism
from ..sim.mujoco import compile_model
from .covers import fixture_mesh, look_name, write_cover
from .footprints import cached_package
from .room import Fixture, Item, Placement, Room
from .solids import fixture_shape, item_poses
from .things import thing_solids
from .views import FIELD_OF_VIEW, find_lamps, find_views

if TYPE_CHECKING:
    from mujoco import MjModel

MJCF_FILE = "scene.xml"
HOME = "home"
"""Name of the keyframe with the coordinates of the room."""
BRIGHTNESS = 0.45
"""Light of all lamps together, besides that of MuJoCo's headlight."""


def write_room_mjcf(room: Room, folder: Path) -> Path:
    """Writes ``scene.xml``, which names the packages relative to ``folder``, and returns its path.

    Raises:
        PackageError: If a package cannot be read, or MuJoCo cannot compile the room.
    """
    root = _room_element(room, folder)
    folder.mkdir(parents=True, exist_ok=True)
    draft = write_whole(folder / f"draft_{MJCF_FILE}", xml_text(root))
    try:
        model = compile_model(draft)
    except ValueError as error:
        text = " ".join(str(error).split())
        raise PackageError(f"{folder}: MuJoCo cannot compile the {room.kind}: {text}") from error
    finally:
        draft.unlink()
    frames = ET.SubElement(root, "keyframe")
    ET.SubElement(frames, "key", name=HOME, qpos=format_vector(home_position(room, model)))
    return write_whole(folder / MJCF_FILE, xml_text(root))


def home_position(room: Room, model: "MjModel") -> Float[np.ndarray, "Q"]:
    """Joint vector of the compiled room with every joint at its coordinate; followers follow, things are
    where the room has them, in drawers that stand open too."""
    qpos = model.qpos0.copy()
    for placement in room.placements:
        package = cached_package(placement.package)
        names = [joint.name for joint in package.joints if joint.type != "fixed"]
        coordinates = dict(placement.joints)
        start = np.array([coordinates.get(name, 0.0) for name in names])
        for name, q in zip(names, find_mechanism(package, names).complete(start), strict=True):
            qpos[model.joint(f"{placement.id}/{name}").qposadr[0]] = q
    for name, T in item_poses(room).items():
        start = model.joint(name).qposadr[0]
        qpos[start : start + 7] = [*T[:3, 3], *quat_from_matrix(T[:3, :3])]
    return qpos


def _room_element(room: Room, folder: Path) -> ET.Element:
    root = ET.Element("mujoco", model=f"{room.kind}_{room.seed}")
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    option = ET.SubElement(root, "option", integrator="implicitfast")
    ET.SubElement(option, "flag", sleep="enable")
    visual = ET.SubElement(root, "visual")
    ET.SubElement(visual, "headlight", ambient="0.5 0.5 0.5", diffuse="0.25 0.25 0.25", specular="0 0 0")
    asset = ET.SubElement(root, "asset")
    ET.SubElement(
        asset, "texture", name="sky", type="skybox", builtin="gradient", rgb1="0.62 0.76 0.90",
        rgb2="0.93 0.95 0.97", width="128", height="128",
    )  # fmt: skip
    models: dict[Path, str] = {}
    for placement in room.placements:
        if placement.package not in models:
            models[placement.package] = f"package_{len(models)}"
            file = os.path.relpath(placement.package.resolve() / "mobility.mjcf.xml", folder.resolve())
            ET.SubElement(asset, "model", name=models[placement.package], file=Path(file).as_posix())
    world = ET.SubElement(root, "worldbody")
    _add_lights_and_cameras(world, room)
    for fixture in room.fixtures:
        _add_fixture(world, asset, fixture, folder)
    for placement in room.placements:
        _add_placement(world, placement, models[placement.package])
    poses = item_poses(room)
    for item in room.contents:
        _add_item(world, item, poses[item.id])
    return root


def _add_lights_and_cameras(world: ET.Element, room: Room) -> None:
    for lamp in find_lamps(room):
        strength = format_vector(np.full(3, lamp.share * BRIGHTNESS), 6)
        ET.SubElement(
            world, "light", name=lamp.name, pos=format_vector(np.array(lamp.position)), dir="0 0 -1",
            diffuse=strength, ambient="0 0 0", specular="0 0 0", cutoff="89", exponent="0.3",
        )  # fmt: skip
    for view in find_views(room):
        right, down, _ = view.camera.axes
        ET.SubElement(
            world, "camera", name=view.name, pos=format_vector(view.camera.position),
            xyaxes=format_vector(np.concatenate([right, -down]), 9),
            fovy=f"{FIELD_OF_VIEW:g}",
        )  # fmt: skip


def _add_fixture(world: ET.Element, asset: ET.Element, fixture: Fixture, folder: Path) -> None:
    """A geom in its colour; with a pattern, it collides, and a mesh with the pattern's image is seen."""
    geom = primitive_geom(fixture_shape(fixture), np.zeros(3)) | {
        "name": fixture.name,
        "rgba": format_vector(np.array([*fixture.color, 1.0]), 6),
        "friction": HULL_FRICTION,
    }
    if fixture.pattern == "plain":
        ET.SubElement(world, "geom", geom)
        return
    ET.SubElement(world, "geom", geom | {"group": "3"})
    look, mesh = look_name(fixture), fixture_mesh(fixture)
    assert mesh.uv is not None
    if all(known.get("name") != look for known in asset.findall("material")):
        file = write_cover(fixture, folder).relative_to(folder).as_posix()
        ET.SubElement(asset, "texture", name=look, type="2d", file=file)
        ET.SubElement(asset, "material", name=look, texture=look, specular="0.1")
    corners = mesh.vertices[mesh.faces].reshape(-1, 3)
    middle = corners.mean(axis=0)
    uv = mesh.uv.reshape(-1, 2) * [1.0, -1.0]  # the image's rows count from its top
    ET.SubElement(
        asset, "mesh", name=fixture.name, inertia="shell", vertex=format_vector((corners - middle).ravel()),
        texcoord=format_vector(uv.ravel()), face=" ".join(map(str, range(len(corners)))),
    )  # fmt: skip
    ET.SubElement(
        world, "geom", name=f"{fixture.name}_cover", type="mesh", mesh=fixture.name, material=look,
        pos=format_vector(middle), group="2", contype="0", conaffinity="0", mass="0",
    )  # fmt: skip


def _add_placement(world: ET.Element, placement: Placement, model: str) -> None:
    frame = ET.SubElement(
        world,
        "frame",
        pos=format_vector(np.array(placement.position)),
        quat=format_vector(np.array(placement.quat)),
    )
    ET.SubElement(frame, "attach", model=model, prefix=f"{placement.id}/")


def _add_item(world: ET.Element, item: Item, T: Float[np.ndarray, "4 4"]) -> None:
    """A loose thing, with its mass spread over its primitives by volume."""
    body = ET.SubElement(
        world,
        "body",
        name=item.id,
        pos=format_vector(T[:3, 3]),
        quat=format_vector(quat_from_matrix(T[:3, :3])),
    )
    ET.SubElement(body, "freejoint", name=item.id)
    solids = thing_solids(item.thing, item.size)
    density = item.mass / sum(solid.volume for solid, _ in solids)
    for solid, color in solids:
        style = {
            "mass": f"{density * solid.volume:.9g}",
            "rgba": format_vector(np.array([*item.colors[color], 1.0]), 6),
            "friction": HULL_FRICTION,
        }
        ET.SubElement(body, "geom", primitive_geom(solid, np.zeros(3)) | style)
