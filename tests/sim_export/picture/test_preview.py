"""Laws of previews: states differ as they should, everything stays in the frame, files are images."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from jaxtyping import Bool, UInt8
from picture_maps import render_ids
from PIL import Image
from sample_cabinet import SAMPLE_PARTS, SamplePart, sample_box_arrays

from artigen.camera import Camera, look_at, project_points
from artigen.types import Gaussians, Joint
from sim_export.errors import PackageError
from sim_export.files.write import write_package
from sim_export.package import Hull, Link, Mesh, Requirement, SimPackage, SourceMesh, Visual
from sim_export.picture.animation import AnimationConfig, animate_packages, write_animation
from sim_export.picture.draw import (
    distinct_color,
    explode_links,
    hull_surfaces,
    load_source_meshes,
    open_end,
    open_links,
    package_surfaces,
    pose_surfaces,
    sweep_qpos,
    swell_hull,
)
from sim_export.picture.lighting import RenderConfig
from sim_export.picture.preview import (
    PreviewConfig,
    contact_sheet,
    describe_joints,
    describe_size,
    preview_package,
    write_preview,
)
from sim_export.picture.render import surface_from_mesh, surface_points
from sim_export.picture.viewpoint import Viewpoint

SMALL = PreviewConfig(
    viewpoint=Viewpoint(width=120, height=120),
    render=RenderConfig(edge_rays=2, occlusion_rays=1, shadow_rays=1),
)
TITLE, CAPTION = 66, 34
"""Heights of the bands above a row and below its panels, in pixels."""


def _mover(part: SamplePart, by_name: Mapping[str, SamplePart]) -> str:
    """Name of the part whose link a part belongs to."""
    while part.joint == "fixed" and part.parent is not None:
        part = by_name[part.parent]
    return part.name


def _link(name: str, parts: list[SamplePart]) -> Link:
    visuals, hulls = [], []
    for part in parts:
        for index, (box, bounds) in enumerate(zip(part.boxes, sample_box_arrays(part), strict=True)):
            solid = trimesh.creation.box(bounds=bounds)
            color = (box.color[0] / 255.0, box.color[1] / 255.0, box.color[2] / 255.0)
            mesh = Mesh(vertices=solid.vertices, faces=solid.faces, color=color)
            visuals.append(Visual(name=f"{part.name}_{index}", part=part.name, label=part.label, mesh=mesh))
            hulls.append(Hull(vertices=solid.vertices, faces=solid.faces))
    return Link(
        name=name, label=parts[0].label, parts=tuple(part.name for part in parts),
        visuals=tuple(visuals), hulls=tuple(hulls), inertial=None,
    )  # fmt: skip


@pytest.fixture(scope="session")
def boxes_package() -> SimPackage:
    """The sample cabinet as a package of exact boxes."""
    by_name = {part.name: part for part in SAMPLE_PARTS}
    movers = [part.name for part in SAMPLE_PARTS if part.joint != "fixed"] + ["body"]
    links = [Link(name="base", label=None, parts=(), visuals=(), hulls=(), inertial=None)]
    joints = []
    for index, mover in enumerate(movers):
        part = by_name[mover]
        members = [other for other in SAMPLE_PARTS if _mover(other, by_name) == mover]
        members.sort(key=lambda other: other.name != mover)
        links.append(_link(f"link_{index}", members))
        parent = "base"
        if part.parent is not None:
            parent = f"link_{movers.index(_mover(by_name[part.parent], by_name))}"
        assert part.joint != "screw"
        joints.append(
            Joint(
                name=f"joint_{index}",
                type=part.joint,
                parent=parent,
                child=f"link_{index}",
                origin=np.array(part.origin),
                axis=np.array(part.axis),
                upper=part.upper,
            )
        )
    return SimPackage(
        name="cabinet", category="StorageFurniture", visual="voxels", links=tuple(links), joints=tuple(joints)
    )


def panels_of(picture: UInt8[np.ndarray, "H W 3"], count: int) -> list[UInt8[np.ndarray, "P Q 3"]]:
    return np.split(picture[TITLE:-CAPTION], count, axis=1)


def drawn(panel: UInt8[np.ndarray, "P Q 3"]) -> Bool[np.ndarray, "P Q"]:
    """Pixels that are clearly the object: the floor is grey, and lighter than it."""
    return (panel.max(axis=2).astype(int) - panel.min(axis=2) > 24) | (panel.max(axis=2) < 130)


@pytest.fixture(scope="session")
def row(boxes_package: SimPackage) -> UInt8[np.ndarray, "H W 3"]:
    return preview_package(boxes_package, SMALL)


def test_states_differ_and_repeat(boxes_package: SimPackage, row):
    assert row.shape == (TITLE + 120 + CAPTION, 5 * 120, 3)
    closed, half, opened, exploded, collision = panels_of(row, 5)
    for one, other in ((closed, half), (half, opened), (closed, exploded), (opened, collision)):
        assert (one != other).any(axis=2).mean() > 0.05
    assert (preview_package(boxes_package, SMALL) == row).all()


def test_everything_is_inside_the_frame(row):
    for panel in panels_of(row, 5):
        rows, columns = np.nonzero(drawn(panel))
        assert len(rows) > 1000
        assert rows.min() >= 4
        assert columns.min() >= 4
        assert rows.max() <= 115
        assert columns.max() <= 115


def test_the_frame_is_filled_by_some_panel(row):
    boxes = [np.nonzero(drawn(panel)) for panel in panels_of(row, 5)]
    extents = np.array([[np.ptp(rows), np.ptp(columns)] for rows, columns in boxes])
    assert extents.max() > 0.7 * 120


def test_the_body_stays_where_it_is_between_panels(row):
    closed, half, opened, _, _ = panels_of(row, 5)
    # The far upper corner of the body: same camera, same place.
    for panel in (half, opened):
        assert (drawn(panel[:14]) == drawn(closed[:14])).all()
    assert drawn(closed[:14]).sum() > 50


def test_captions_and_facts(boxes_package: SimPackage, row):
    assert (row[:TITLE] < 128).all(axis=2).sum() > 100
    for caption in np.split(row[-CAPTION:], 5, axis=1):
        ink = np.nonzero((caption < 140).all(axis=2))
        assert len(ink[0]) > 30
        assert abs(ink[1].mean() - 60) < 4
    assert describe_size(boxes_package) == "0.80 m wide, 0.55 m deep, 1.00 m high"
    assert describe_joints(boxes_package) == "4 joints (1 continuous, 2 prismatic, 1 revolute)"


def test_a_surface_has_the_number_of_its_link(boxes_package: SimPackage):
    assert {surface.id for surface in package_surfaces(boxes_package)} == {1, 2, 3, 4, 5}


def test_hull_colors_are_distinct():
    colors = np.array([distinct_color(index) for index in range(12)])
    apart = np.linalg.norm(colors[:, None] - colors[None], axis=2) + 10.0 * np.eye(12)
    assert apart.min() > 0.12
    assert colors.min() >= 0.0
    assert colors.max() <= 1.0


def test_a_swollen_box_is_the_larger_box():
    box = trimesh.creation.box(extents=(0.4, 1.0, 0.02))
    larger = swell_hull(Hull(vertices=box.vertices, faces=box.faces), 0.01)
    assert larger == pytest.approx(box.vertices + 0.01 * np.sign(box.vertices))


def test_of_hulls_that_share_a_plane_one_is_seen_all_over(boxes_package: SimPackage):
    """Two plates with a common front: without a decision their colours would mix at random."""
    plates = [trimesh.creation.box(bounds=[[0, -0.5, -0.5], [0.1 * k, 0.5, 0.5]]) for k in (1, 2)]
    turned = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    hulls = tuple(Hull(vertices=plate.vertices @ turned, faces=plate.faces) for plate in plates)
    package = replace(boxes_package, links=(replace(boxes_package.links[1], hulls=hulls),), joints=())
    first, second = hull_surfaces(package)
    front = look_at(np.array([-3.0, 0.3, 0.2]) @ turned, np.zeros(3))
    ids = render_ids([first, replace(second, id=second.id + 1)], front)
    assert len(np.unique(ids[ids >= 0])) <= 2
    middle = ids[180:204, 180:204]
    assert len(np.unique(middle)) == 1


def test_open_ends_and_exploded_links(boxes_package: SimPackage):
    surfaces = package_surfaces(boxes_package)
    ends = [open_end(joint) for joint in boxes_package.joints]
    assert ends[:4] == pytest.approx([0.36, np.pi / 2, np.pi / 2, 0.30])
    assert open_end(replace(boxes_package.joints[0], lower=-0.5, upper=0.0)) == -0.5
    assert open_links(boxes_package, 0.0) == pytest.approx(np.tile(np.eye(4), (6, 1, 1)))
    T = explode_links(boxes_package, surfaces, 0.5)
    step = 0.5 * np.linalg.norm(np.ptp(surface_points(surfaces), axis=0))
    moved = T[:, :3, 3]
    assert moved[[0, 5]] == pytest.approx(np.zeros((2, 3)))
    assert moved[[1, 2, 4]] == pytest.approx(np.tile([-step, 0.0, 0.0], (3, 1)), abs=0.06 * step)
    assert moved[3] == pytest.approx(moved[2] + np.array([-step, 0.0, 0.0]))  # the lock leaves the door


def test_contact_sheet_is_a_grid(boxes_package: SimPackage):
    three = [replace(boxes_package, name=name) for name in ("a", "b", "c")]
    sheet = contact_sheet(three, replace(SMALL, columns=2))
    assert sheet.shape == (2 * (120 + CAPTION), 2 * 240, 3)
    assert (sheet[-(120 + CAPTION) :, 240:] == SMALL.render.background).all()
    closed, opened = sheet[:120, :120], sheet[:120, 120:240]
    assert (closed != opened).any(axis=2).mean() > 0.05


def test_a_sweep_goes_from_closed_to_open_and_waits_for_what_must_be_open_first(boxes_package: SimPackage):
    joints = [joint.name for joint in boxes_package.joints if joint.type != "fixed"]
    first, second, third = joints[:3]
    needs = tuple(
        Requirement(joint=joint, needs=other, fraction=0.9)
        for joint, other in ((second, first), (third, second))
    )
    package = replace(boxes_package, requires_open=needs)
    ends = {joint.name: open_end(joint) for joint in package.joints}
    assert set(sweep_qpos(package, 0.0).values()) == {0.0}
    assert sweep_qpos(package, 1.0) == pytest.approx({name: ends[name] for name in joints})
    before = dict.fromkeys(joints, 0.0)
    for time in np.linspace(0.0, 1.0, 40):
        share = {name: value / ends[name] for name, value in sweep_qpos(package, float(time)).items()}
        assert all(share[name] >= before[name] - 1e-12 for name in joints)
        assert share[second] == 0 or share[first] >= 0.9
        assert share[third] == 0 or share[second] >= 0.9
        before = share


def test_animations_go_there_and_back_in_the_time_they_have(tmp_path: Path, boxes_package: SimPackage):
    cfg = AnimationConfig(states=3, seconds=2.0, rest=0.4, preview=replace(SMALL, columns=2))
    write_package(boxes_package, tmp_path / "cabinet")
    write_animation([tmp_path / "cabinet"] * 3, tmp_path / "three.gif", cfg)
    gif = Image.open(tmp_path / "three.gif")
    assert (gif.n_frames, gif.size, gif.info["loop"]) == (4, (240, 240), 0)
    pictures, times = [], []
    for frame in range(gif.n_frames):
        gif.seek(frame)
        pictures.append(np.asarray(gif.convert("RGB")).astype(int))
        times.append(gif.info["duration"])
    assert times == [400, 600, 400, 600]
    assert np.array_equal(pictures[1], pictures[3])
    states = animate_packages([boxes_package] * 3, cfg)
    for picture, state in zip(pictures, states, strict=False):
        assert np.abs(picture - state).mean() < 3  # 256 colours
    assert (states[0] != states[2])[:120, :120].any(axis=2).mean() > 0.05
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cabinet", "three.gif"]
    with pytest.raises(ValueError, match="leave time"):
        AnimationConfig(seconds=1.0, rest=0.5)


def _write_square(folder: Path, image: str | None) -> SourceMesh:
    """A unit square facing -x in an OBJ of centimetres, upper half red and lower half blue."""
    pixels = np.zeros((8, 8, 3), np.uint8)
    pixels[:4], pixels[4:] = (230, 20, 20), (20, 20, 230)
    Image.fromarray(pixels).save(folder / "paint.png")
    (folder / "square.mtl").write_text("newmtl paint\nKd 1 1 1\n" + (f"map_Kd {image}\n" if image else ""))
    (folder / "square.obj").write_text(
        "mtllib square.mtl\nv 0 50 -50\nv 0 -50 -50\nv 0 -50 50\nv 0 50 50\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "usemtl paint\nf 1/1 2/2 3/3 4/4\n"
    )
    T = np.eye(4)
    T[:3, 3] = [0.0, 0.0, 2.0]
    return SourceMesh(path=folder / "square.obj", T_object_file=T, scale=0.01)


def _square_package(source: SourceMesh) -> SimPackage:
    visual = Visual(name="square", part="square", label="base", mesh=source)
    link = Link(name="base", label="base", parts=("square",), visuals=(visual,), hulls=(), inertial=None)
    return SimPackage(name="square", category="Table", visual="source", links=(link,), joints=())


def test_source_meshes_keep_their_place_scale_and_texture(tmp_path: Path):
    source = _write_square(tmp_path, "paint.png")
    (mesh,) = load_source_meshes(source)
    assert mesh.vertices.min(axis=0) == pytest.approx([0.0, -0.5, 1.5])
    assert mesh.vertices.max(axis=0) == pytest.approx([0.0, 0.5, 2.5])
    picture = preview_package(_square_package(source), replace(SMALL, panels=("closed",)))[TITLE:-CAPTION]
    red = (picture[..., 0] > 120) & (picture[..., 2] < 90)
    blue = (picture[..., 2] > 120) & (picture[..., 0] < 90)
    assert red.sum() > 1000
    assert blue.sum() > 1000
    assert np.nonzero(red)[0].mean() < np.nonzero(blue)[0].mean() - 20


@pytest.mark.parametrize("image", ["paint.png", None])
def test_a_pane_of_a_source_shows_what_is_behind_it(tmp_path: Path, image: str | None):
    source = _write_square(tmp_path, image)
    (opaque,) = load_source_meshes(source)
    materials = tmp_path / "square.mtl"
    materials.write_text(materials.read_text().replace("Kd 1 1 1", "Kd 0 1 0\nd 0.2"))
    (pane,) = load_source_meshes(source)
    assert (opaque.texture is None) == (image is None)
    assert pane.material.opacity == 0.2
    shown = surface_from_mesh(pane).texture
    assert shown is not None
    assert set(shown[..., 3].ravel().tolist()) == {51}
    if opaque.texture is None:
        assert shown.tolist() == [[[0, 255, 0, 51]]]
    else:
        np.testing.assert_array_equal(shown[..., :3], opaque.texture)


def test_a_source_mesh_without_its_image_is_an_error(tmp_path: Path):
    with pytest.raises(PackageError, match=r"gone\.png"):
        load_source_meshes(_write_square(tmp_path, "gone.png"))
    source = _write_square(tmp_path, None)
    text = source.path.read_text().replace("usemtl paint", "usemtl wood")
    source.path.write_text(text)
    with pytest.raises(PackageError, match=r"'wood'.*square\.mtl.*paint"):
        load_source_meshes(source)


def test_nothing_to_draw_is_an_error(boxes_package: SimPackage):
    with pytest.raises(ValueError, match="'cabinet' has no visual"):
        preview_package(replace(boxes_package, links=boxes_package.links[:1], joints=()), SMALL)
    with pytest.raises(ValueError, match="no packages"):
        contact_sheet([], SMALL)
    with pytest.raises(ValueError, match="at least one panel"):
        PreviewConfig(panels=())


def test_previews_of_written_packages(tmp_path: Path, boxes_package: SimPackage):
    folder = tmp_path / "cabinet"
    write_package(boxes_package, folder)
    write_preview([folder], tmp_path / "one.png", SMALL)
    write_preview([folder, folder], tmp_path / "two.png", SMALL)
    one, two = (np.asarray(Image.open(tmp_path / name)) for name in ("one.png", "two.png"))
    assert one.shape == (TITLE + 120 + CAPTION, 600, 3)
    assert two.shape == (120 + CAPTION, 480, 3)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cabinet", "one.png", "two.png"]


@pytest.mark.real
@pytest.mark.parametrize("name", ["10849"])
def test_real_objects_open_inside_the_frame(real_objects: Path, name: str):
    from sim_export.files.read import read_package

    package = read_package(real_objects / "partnet_mobility" / name)
    cfg = replace(SMALL, panels=("closed", "open"), render=replace(SMALL.render, ground=False))
    closed, opened = panels_of(preview_package(package, cfg), 2)
    assert (closed != opened).any(axis=2).mean() > 0.03
    for panel in (closed, opened):
        seen = (panel != np.array(cfg.render.background)).any(axis=2)
        assert seen.mean() > 0.15
        assert not seen[:4].any()
        assert not seen[-4:].any()
        assert not seen[:, :4].any()
        assert not seen[:, -4:].any()


def test_gaussians_stand_below_the_meshes_in_the_same_poses(boxes_package: SimPackage):
    links = []
    for index, link in enumerate(boxes_package.links):
        corners = np.concatenate([np.zeros((0, 3)), *(visual.mesh.vertices for visual in link.visuals)])
        splats = Gaussians(
            means=corners,
            quats=np.tile([1.0, 0.0, 0.0, 0.0], (len(corners), 1)),
            scales=np.full((len(corners), 3), 0.01),
            opacities=np.ones(len(corners)),
            colors=np.full((len(corners), 3), 0.5),
            part_ids=np.full(len(corners), index),
        )
        links.append(replace(link, splats=splats if len(corners) else None))
    package = replace(boxes_package, links=tuple(links))
    drawn_sets: list[Gaussians] = []

    def draw(gaussians: Gaussians, camera: Camera, background: tuple[int, int, int]) -> np.ndarray:
        drawn_sets.append(gaussians)
        seen = project_points(camera, gaussians.means.astype(float))
        assert ((seen[:, :2] >= 0) & (seen[:, :2] <= [camera.width, camera.height])).all()
        return np.full((camera.height, camera.width, 3), 7, dtype=np.uint8)

    cfg = replace(SMALL, panels=("closed", "open", "collision"))
    plain, both = preview_package(package, cfg), preview_package(package, cfg, draw)
    assert both.shape[0] > plain.shape[0]
    np.testing.assert_array_equal(both[: len(plain)], plain)
    assert (both == 7).all(axis=2).sum() == 2 * cfg.viewpoint.width * cfg.viewpoint.height
    posed = pose_surfaces(package_surfaces(package), open_links(package, 1.0))
    wanted = np.concatenate([surface.triangles.reshape(-1, 3) for surface in posed])
    np.testing.assert_allclose(drawn_sets[1].means.min(axis=0), wanted.min(axis=0), atol=1e-5)
    np.testing.assert_allclose(drawn_sets[1].means.max(axis=0), wanted.max(axis=0), atol=1e-5)
    assert np.abs(drawn_sets[0].means - drawn_sets[1].means).max() > 0.05
    # Without Gaussians, nothing is drawn and nothing changes.
    np.testing.assert_array_equal(preview_package(boxes_package, cfg, draw), plain)
    sheet = contact_sheet([package, boxes_package], cfg, draw)
    assert (sheet == 7).all(axis=2).sum() == 2 * cfg.viewpoint.width * cfg.viewpoint.height
