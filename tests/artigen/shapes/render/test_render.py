"""The ray caster against closed forms, a brute-force oracle in float64, and rigid motion."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import torch

from artigen.camera import frame_points
from artigen.shapes.fittings.hardware import rotate, slide
from artigen.shapes.poses import open_parts, pose_parts
from artigen.shapes.primitives import (
    Primitive,
    box,
    contains,
    cylinder,
    move,
    place_vertices,
    polytope,
    prism,
    rounded_box,
)
from artigen.shapes.render import Cameras, Images, RenderConfig, batch_cameras, build_scene, render
from artigen.shapes.shape import Shape, ShapePart, make_base
from artigen.shapes.sheet import draw_sheet
from artigen.shapes.surfaces.materials import LACQUERS, make_glass, make_lacquer
from artigen.shapes.surfaces.palette import draw_palette
from artigen.types import Joint

GEOMETRY = RenderConfig(shadow_rays=0, openness=False)


def make_shape(*parts: ShapePart, glass_opacity: float = 0.2) -> Shape:
    finishes = draw_palette(np.random.default_rng(0), "furniture", "flat")
    # No pattern: what moves must look the same wherever it is.
    finishes |= {"plain": replace(make_lacquer(LACQUERS["sage"]), accent=LACQUERS["sage"])}
    finishes |= {"glass": make_glass((0.03, 0.03, 0.04), opacity=glass_opacity)}
    return Shape(category="Test", seed=0, style="flat", parts=parts, finishes=tuple(finishes.items()))


def one_part(*primitives: Primitive) -> ShapePart:
    return ShapePart("body", "base", primitives, parent=None)


def front_camera(size: int = 64, distance: float = 3.0, fov: float = 30.0) -> Cameras:
    return Cameras(
        position=torch.tensor([[-distance, 0.0, 0.0]], dtype=torch.float64),
        target=torch.zeros(1, 3, dtype=torch.float64),
        fov=torch.tensor([fov], dtype=torch.float64),
        width=size,
        height=size,
    )


def see(shape: Shape, cameras: Cameras, qpos=None, cfg: RenderConfig = GEOMETRY) -> Images:
    state = np.zeros(len(shape.parts)) if qpos is None else np.asarray(qpos)
    return render(build_scene([shape]), cameras, [state] * len(cameras.fov), cfg=cfg)


def pixel_rays(cameras: Cameras, image: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Origin and directions (float64, length one along the view), written apart from the package."""
    origin = cameras.position[image].numpy()
    forward = cameras.target[image].numpy() - origin
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    pixel = 2 * np.tan(np.radians(float(cameras.fov[image])) / 2) / cameras.height
    x = (np.arange(cameras.width) + 0.5 - cameras.width / 2) * pixel
    y = (np.arange(cameras.height) + 0.5 - cameras.height / 2) * pixel
    return origin, forward + x[None, :, None] * right + y[:, None, None] * down


def cast_alone(primitive: Primitive, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Depth of one solid by its definition, infinite where missed."""
    o = (origin - primitive.center) @ primitive.rotation
    d = rays @ primitive.rotation
    enter, leave = np.zeros(rays.shape[:2]), np.full(rays.shape[:2], np.inf)
    planes = primitive.planes
    with np.errstate(divide="ignore", invalid="ignore"):
        if primitive.kind == "cylinder":
            half = primitive.size[2] / 2
            planes = np.array([[0, 0, 1, -half], [0, 0, -1, -half]], dtype=float)
            a = (d[..., :2] ** 2).sum(axis=-1)
            b = (d[..., :2] * o[:2]).sum(axis=-1)
            root = b * b - a * ((o[:2] ** 2).sum() - primitive.size[0] ** 2 / 4)
            enter = np.where(root < 0, np.inf, (-b - np.sqrt(np.maximum(root, 0))) / a)
            leave = np.where(root < 0, -np.inf, (-b + np.sqrt(np.maximum(root, 0))) / a)
        for plane in planes:
            speed = d @ plane[:3]
            at = -(o @ plane[:3] + plane[3]) / speed
            enter = np.where(speed < 0, np.maximum(enter, at), enter)
            leave = np.where(speed > 0, np.minimum(leave, at), leave)
    return np.where(enter < leave, enter, np.inf)


def pile(seed: int) -> Shape:
    """Sixty solids of all kinds in several parts, each turned as it likes."""
    rng = np.random.default_rng(seed)

    def solid() -> Primitive:
        size = rng.uniform(0.04, 0.25, 3)
        corners = rng.normal(size=(12, 3)) * size / 2
        made = [
            lambda: box((0, 0, 0), tuple(size), "plain"),
            lambda: rounded_box((0, 0, 0), tuple(size), float(size.min() / 5), "plain"),
            lambda: cylinder((0, 0, 0), tuple(size), float(size[0] / 4), "plain"),
            lambda: prism(corners[:5, :2], (0, 0, 0), (0, 0, float(size[2])), "plain", taper=0.7),
            lambda: polytope(corners, "plain"),
        ][rng.integers(5)]()
        turned = move(made, turn=float(rng.uniform(0, 6)), about=tuple(rng.normal(size=3)))
        return move(turned, tuple(rng.uniform(-0.5, 0.5, 3)))

    body = [solid() for _ in range(30)]
    parts = [make_base(tuple(body))]
    parts += [ShapePart(f"p{k}", "knob", (solid(), solid(), solid())) for k in range(10)]
    return make_shape(*parts)


def around(count: int, size: int = 48) -> Cameras:
    rng = np.random.default_rng(count)
    return Cameras(
        position=torch.tensor(rng.normal(size=(count, 3)) * 0.4 + [-2.0, 0.3, 0.7]),
        target=torch.tensor(rng.normal(size=(count, 3)) * 0.1),
        fov=torch.tensor(rng.uniform(20, 45, count)),
        width=size + 7,
        height=size,
    )


def test_depth_of_a_box_is_the_distance_of_its_face():
    seen = see(make_shape(one_part(box((-0.2, -0.4, -0.3), (0.2, 0.4, 0.3), "plain"))), front_camera())
    _, rays = pixel_rays(front_camera())
    inside = (np.abs(rays[..., 1] * 2.8) < 0.4) & (np.abs(rays[..., 2] * 2.8) < 0.3)
    assert np.array_equal(seen.mask[0].numpy(), inside)
    assert np.abs(seen.depth[0].numpy()[inside] - 2.8).max() < 1e-6
    assert torch.isinf(seen.depth[0][~seen.mask[0]]).all()
    assert torch.equal(seen.normals[0][seen.mask[0]].unique(dim=0), torch.tensor([[-1.0, 0.0, 0.0]]))


@pytest.mark.parametrize("radius", [0.4, 0.003])
def test_depth_of_a_cylinder_is_its_closed_form(radius: float):
    camera = front_camera(size=301)
    rod = cylinder((0.0, 0.0, -0.3), (0.0, 0.0, 0.3), radius, "plain")
    seen = see(make_shape(one_part(rod)), camera)
    _, rays = pixel_rays(camera)
    y, z = rays[..., 1], rays[..., 2]
    root = radius**2 * (1 + y**2) - 9 * y**2
    depth = (3 - np.sqrt(np.maximum(root, 0))) / (1 + y**2)
    inside = (root > 0) & (np.abs(z * depth) < 0.3)
    assert inside.sum() > 100
    assert np.array_equal(seen.mask[0].numpy(), inside)
    assert np.abs(seen.depth[0].numpy()[inside] - depth[inside]).max() < 3e-6
    at = (-np.array([3.0, 0, 0]) + rays * depth[..., None])[inside]
    outward = at / radius * [1, 1, 0]
    assert np.abs(seen.normals[0].numpy()[inside] - outward).max() < 3e-3


@pytest.mark.parametrize("seed", [0, 1])
def test_a_pile_of_solids_agrees_with_brute_force(seed: int):
    shape, cameras = pile(seed), around(3)
    seen = see(shape, cameras)
    solids = [(index, p) for index, part in enumerate(shape.parts) for p in part.primitives]
    for image in range(3):
        origin, rays = pixel_rays(cameras, image)
        depths = np.stack([cast_alone(p, origin, rays) for _, p in solids])
        nearest = depths.min(axis=0)
        mask, depth = seen.mask[image].numpy(), seen.depth[image].numpy().astype(float)
        depth[~mask] = 0.0
        assert np.isfinite(nearest).sum() > 500
        assert (np.isfinite(nearest) != mask).sum() <= 2  # rays that graze an edge
        both = np.isfinite(nearest) & mask
        off = np.zeros_like(mask)
        off[both] = np.abs(depth[both] - nearest[both]) > 1e-4 * nearest[both]
        assert off.sum() <= 2
        clear = both & (np.partition(depths, 1, axis=0)[1] > nearest + 1e-3) & ~off
        owners = np.array([part for part, _ in solids])[depths.argmin(axis=0)]
        assert np.array_equal(seen.part_ids[image].numpy()[clear], owners[clear])


def test_normals_are_unit_face_the_camera_and_are_those_of_the_surface():
    shape, cameras = pile(2), around(2)
    seen = see(shape, cameras)
    solids = [p for part in shape.parts for p in part.primitives]
    for image in range(2):
        origin, rays = pixel_rays(cameras, image)
        mask = seen.mask[image].numpy()
        normals = seen.normals[image].numpy()[mask].astype(float)
        assert np.abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-5
        assert np.einsum("ij,ij->i", normals, rays[mask]).max() < 1e-5
        at = origin + rays[mask] * seen.depth[image].numpy()[mask][:, None].astype(float)
        below = np.any([contains(p, at - 1e-4 * normals) for p in solids], axis=0)
        above = np.any([contains(p, at + 1e-4 * normals) for p in solids], axis=0)
        assert below.mean() > 0.98  # sharp edges aside
        assert above.mean() < 0.02
    assert (seen.normals[~seen.mask] == 0).all()


def test_the_mask_is_the_union_of_the_parts():
    shape, cameras = pile(3), around(2)
    whole = see(shape, cameras)
    alone = [see(make_shape(replace(part, parent=None)), cameras) for part in shape.parts]
    assert torch.equal(whole.mask, torch.stack([seen.mask for seen in alone]).any(dim=0))
    assert torch.equal(whole.depth, torch.stack([seen.depth for seen in alone]).amin(dim=0))
    assert torch.equal(whole.mask, whole.part_ids >= 0)


@pytest.mark.parametrize("fov", [30.0, 7.3])
def test_touching_boxes_have_no_cracks(fov: float):
    edges = np.linspace(-0.5, 0.5, 12)
    wall = [
        move(box((0, y0, z0), (0.02, y1, z1), "plain"), turn=0.3)
        for y0, y1 in pairwise(edges)
        for z0, z1 in pairwise(edges)
    ]
    whole = move(box((0, -0.5, -0.5), (0.02, 0.5, 0.5), "plain"), turn=0.3)
    camera = front_camera(size=200, fov=fov)
    seen, expected = see(make_shape(one_part(*wall)), camera), see(make_shape(one_part(whole)), camera)
    assert torch.equal(seen.mask, expected.mask)
    assert (seen.depth - expected.depth)[seen.mask].abs().max() < 1e-5


@pytest.mark.parametrize(
    "motion",
    [
        slide(0.4),
        rotate((0.0, 0.0, 1.0), (-0.2, 0.3, 0.0), 1.5),
        Joint(
            type="screw",
            axis=np.array([0.0, 0.0, 1.0]),
            origin=np.array([0.1, 0.0, 0.0]),
            upper=3.0,
            pitch=0.05,
        ),
    ],
)
def test_a_joint_moves_the_picture_as_moving_the_solids_does(motion: Joint):
    door = (
        box((-0.2, -0.3, -0.2), (-0.18, 0.3, 0.2), "plain"),
        cylinder((-0.2, 0, 0), (-0.25, 0, 0), 0.03, "plain"),
    )
    fixed = box((-0.15, -0.3, -0.2), (0.2, 0.3, -0.1), "plain")
    body = make_base((fixed,))
    moving = ShapePart("door", "door", door, motion)
    knob = ShapePart("knob", "knob", (box((-0.3, 0, 0.1), (-0.2, 0.1, 0.12), "plain"),), parent="door")
    shape = make_shape(body, moving, knob)
    qpos = open_parts(shape, 0.7)
    T = pose_parts(shape, qpos)[1]
    turn = 0.7 * motion.upper if motion.type != "prismatic" else 0.0

    def carry(p: Primitive) -> Primitive:
        return move(p, tuple(float(v) for v in T[:3, 3]), turn=turn, about=tuple(motion.axis.tolist()))

    rest = [
        replace(part, joint=None, primitives=tuple(map(carry, part.primitives))) for part in (moving, knob)
    ]
    there = make_shape(body, *rest)
    cfg = RenderConfig()
    one, other = see(shape, around(2), qpos, cfg), see(there, around(2), cfg=cfg)
    assert one.mask.sum() > 400
    assert (one.mask != other.mask).sum() <= 2
    same = one.mask & other.mask
    assert (one.depth - other.depth)[same].abs().max() < 1e-4
    assert ((one.rgb - other.rgb).abs().amax(dim=-1) > 0.02).float().mean() < 0.002
    closed = see(shape, around(2), cfg=cfg)
    assert (closed.mask != one.mask).sum() > 50


def test_glass_shows_what_is_behind_and_is_the_surface_in_the_maps():
    back = box((0.3, -0.5, -0.5), (0.32, 0.5, 0.5), "plain")
    pane = box((-0.3, -0.2, -0.2), (-0.29, 0.2, 0.2), "glass")
    parts = (one_part(back), ShapePart("pane", "door", (pane,)))
    middle = (0, 32, 32)
    shown = [see(make_shape(*parts, glass_opacity=opacity), front_camera()) for opacity in (1.0, 0.2)]
    assert [int(seen.part_ids[middle]) for seen in shown] == [1, 1]
    assert abs(float(shown[1].depth[middle]) - 2.7) < 1e-5
    plain = see(make_shape(parts[0]), front_camera()).rgb[middle]
    away = [float((seen.rgb[middle] - plain).abs().max()) for seen in shown]
    assert away[1] < 0.5 * away[0]
    assert away[1] > 0.0


def test_shadows_are_the_ones_of_the_light():
    ground = box((-1, -1, -0.02), (1, 1, 0.0), "plain")
    roof = box((-0.3, -0.3, 0.5), (0.3, 0.3, 0.52), "plain")
    post = cylinder((0.6, 0.6, 0.0), (0.6, 0.6, 0.4), 0.05, "plain")
    shape = make_shape(one_part(ground, roof, post))
    cameras = Cameras(
        position=torch.tensor([[-2.5, 0.1, 2.0]], dtype=torch.float64),
        target=torch.zeros(1, 3, dtype=torch.float64),
        fov=torch.tensor([45.0]),
        width=96,
        height=96,
    )
    lamp = np.array([-0.5, 0.4, 0.75])
    cfg = RenderConfig(openness=False, sky_strength=0.0, lamp=tuple(lamp), background=(0.0, 0.0, 0.0))
    dark, lit = (
        see(shape, cameras, cfg=cfg).rgb[0],
        see(shape, cameras, cfg=replace(cfg, shadow_rays=0)).rgb[0],
    )
    origin, rays = pixel_rays(cameras)
    at = origin + rays * see(shape, cameras).depth[0].numpy()[..., None]
    on_ground = np.isfinite(at[..., 2]) & (np.abs(at[..., 2]) < 1e-4)
    reach = np.linspace(0.003, 1.2, 500)[:, None, None, None] * lamp / np.linalg.norm(lamp)
    blocked = np.zeros(on_ground.shape, dtype=bool)
    blocked[on_ground] = [
        any(contains(p, point + reach[:, 0, 0]).any() for p in (roof, post)) for point in at[on_ground]
    ]
    changed = ((lit - dark).abs().amax(dim=-1) > 1e-3).numpy()
    assert 100 < blocked.sum() < on_ground.sum() - 100
    assert (blocked != changed)[on_ground].sum() <= 0.02 * on_ground.sum()


def test_a_batch_gives_the_pictures_of_its_members():
    first, second = pile(4), make_shape(one_part(cylinder((0, 0, -0.3), (0, 0.1, 0.3), 0.1, "body")))
    cameras = around(3, size=32)
    scene, ids = build_scene([first, second]), [1, 0, 1]
    shapes = [first, second]
    states = [np.zeros(len(shapes[k].parts)) for k in ids]
    batch = render(scene, cameras, states, shape_ids=ids)
    for image, k in enumerate(ids):
        own = Cameras(
            position=cameras.position[image : image + 1],
            target=cameras.target[image : image + 1],
            fov=cameras.fov[image : image + 1],
            width=cameras.width,
            height=cameras.height,
        )
        alone = render(build_scene([shapes[k]]), own, [states[image]])
        assert torch.equal(batch.mask[image], alone.mask[0])
        assert torch.equal(batch.part_ids[image], alone.part_ids[0])
        close = (batch.rgb[image] - alone.rgb[0]).abs().amax(dim=-1) < 1e-3
        if k == 0:  # boards of the second shape have other numbers in the scene, not other looks
            assert close.float().mean() > 0.99
        assert close.float().mean() > 0.98


def test_pictures_are_the_same_on_every_run():
    shape, cameras = pile(5), around(2)
    one, other = see(shape, cameras, cfg=RenderConfig()), see(shape, cameras, cfg=RenderConfig())
    assert all(torch.equal(getattr(one, name), getattr(other, name)) for name in vars(one))


def test_supersampling_changes_edges_alone():
    shape, camera = make_shape(one_part(box((-0.2, -0.4, -0.3), (0.2, 0.4, 0.3), "plain"))), front_camera()
    one = see(shape, camera)
    many = see(shape, camera, cfg=replace(GEOMETRY, supersampling=3))
    assert torch.equal(one.depth, many.depth)
    inside = torch.nn.functional.max_pool2d((~one.mask).float()[:, None], 3, 1, 1)[:, 0] == 0
    assert (one.rgb - many.rgb)[inside].abs().max() < 0.01
    edge = one.mask & ~inside
    assert (one.rgb - many.rgb)[edge].abs().max() > 0.05


def test_a_framed_object_is_inside_the_picture_and_touches_its_margins():
    shape = pile(6)
    corners = np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])
    cameras = batch_cameras([frame_points(corners, (-1.0, 0.5, 0.4), width=120, height=100)])
    columns, rows = torch.nonzero(see(shape, cameras).mask[0]).unbind(1)[::-1]
    assert columns.min() >= 6
    assert columns.max() <= 113
    assert rows.min() >= 5
    assert rows.max() <= 94
    assert min(int(columns.min()) - 7, int(rows.min()) - 6) <= 1


def test_a_camera_inside_a_room_sees_its_walls():
    walls = [box((-1, -1, -1.1), (1, 1, -1), "plain"), box((1, -1, -1), (1.1, 1, 1), "plain")]
    walls += [box((-1, -1.1, -1), (1, -1, 1), "plain"), box((-1, 1, -1), (1, 1.1, 1), "plain")]
    camera = Cameras(
        position=torch.tensor([[-0.9, 0.0, 0.2]], dtype=torch.float64),
        target=torch.tensor([[1.0, 0.1, -0.1]], dtype=torch.float64),
        fov=torch.tensor([90.0]),
        width=60,
        height=60,
    )
    seen = see(make_shape(one_part(*walls)), camera)
    origin, rays = pixel_rays(camera)
    nearest = np.min([cast_alone(p, origin, rays) for p in walls], axis=0)
    assert np.array_equal(seen.mask[0].numpy(), np.isfinite(nearest))
    hit = np.isfinite(nearest)
    assert np.abs(seen.depth[0].numpy()[hit] - nearest[hit]).max() < 1e-5


@pytest.mark.parametrize("cfg", [RenderConfig(), RenderConfig(floor=True, supersampling=2, shadow_rays=4)])
def test_an_object_out_of_sight_leaves_the_background(cfg: RenderConfig):
    away = replace(front_camera(), target=torch.tensor([[-6.0, 0.0, 0.0]], dtype=torch.float64))
    seen = see(make_shape(one_part(box((0, 0, 0), (1, 1, 1), "glass"))), away, cfg=cfg)
    assert not seen.mask.any()
    assert (seen.part_ids == -1).all()
    assert (seen.rgb - torch.tensor(cfg.background)).abs().max() < 1e-3


def test_the_floor_is_dark_beneath_the_object_and_bright_far_from_it():
    shape = make_shape(one_part(box((-0.2, -0.3, 0.3), (0.2, 0.3, 0.5), "plain")))
    cameras = Cameras(
        position=torch.tensor([[-3.0, 0.0, 1.2]], dtype=torch.float64),
        target=torch.tensor([[0.0, 0.0, 0.2]], dtype=torch.float64),
        fov=torch.tensor([45.0]),
        width=80,
        height=80,
    )
    cfg = RenderConfig(floor=True, shadow_rays=8)
    seen = see(shape, cameras, cfg=cfg)
    origin, rays = pixel_rays(cameras)
    floor = origin + rays * (-origin[2] / rays[..., 2])[..., None]
    visible = ~seen.mask[0].numpy() & (rays[..., 2] < -1e-3)
    beneath = visible & (np.abs(floor[..., :2] - [0.05, 0.0]) < [0.1, 0.15]).all(axis=-1)
    far = visible & (np.linalg.norm(floor[..., :2], axis=-1) > 1.2)
    bright = seen.rgb[0].mean(dim=-1).numpy()
    assert beneath.sum() > 10
    assert far.sum() > 50
    assert bright[beneath].max() < bright[far].min() - 0.1
    assert np.allclose(bright[visible & (floor[..., 0] < -1.5)], np.mean(cfg.background), atol=0.01)


def test_a_sheet_has_a_picture_per_shape_and_shows_them_open():
    door = box((-0.2, -0.3, 0.0), (-0.18, 0.3, 0.4), "plain")
    motion = slide(0.3)
    body = make_base((box((-0.17, -0.3, 0), (0.2, 0.3, 0.5), "body"),))
    moving = ShapePart("door", "drawer", (door,), motion)
    shapes = [make_shape(body, moving), make_shape(body)]
    closed, opened = (draw_sheet(shapes, fraction, 40, columns=1) for fraction in (0.0, 1.0))
    assert closed.shape == opened.shape == (80, 40, 3)
    assert np.array_equal(closed[40:], opened[40:])  # nothing to open
    assert (closed[:40] != opened[:40]).any(axis=-1).sum() > 50
    row = draw_sheet(shapes[1:], 0.0, 40, columns=2)
    assert np.array_equal(row[:, :40], closed[40:])
    assert (row[:, 40:] == 255).all()
    with pytest.raises(ValueError, match="at least one"):
        draw_sheet([], 0.0)


def test_poses_and_arguments_are_checked():
    shape = make_shape(one_part(box((0, 0, 0), (1, 1, 1), "plain")))
    with pytest.raises(ValueError, match="expected one per part, 1"):
        pose_parts(shape, np.zeros(3))
    with pytest.raises(ValueError, match="1 cameras, 2 joint states"):
        render(build_scene([shape]), front_camera(), [np.zeros(1)] * 2)
    with pytest.raises(ValueError, match="above each other"):
        replace(front_camera(), target=torch.tensor([[-3.0, 0.0, 5.0]], dtype=torch.float64))
    with pytest.raises(ValueError, match="at least one shape"):
        build_scene([])
    with pytest.raises(ValueError, match="multiples of 4"):
        RenderConfig(supersampling=2, shadow_rays=6)


@pytest.mark.parametrize("widths", [(), (20, 21)])
def test_a_batch_has_cameras_of_one_size(widths: tuple[int, ...]):
    cameras = [frame_points(np.eye(3), (-1.0, 0.5, 0.4), width=width, height=20) for width in widths]
    with pytest.raises(ValueError, match="expected one size"):
        batch_cameras(cameras)
