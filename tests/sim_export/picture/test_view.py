"""The browser view: sliders, buttons and toggles do to the scene what forward kinematics says."""

import socket
import time
import urllib.request
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from artigen.transforms import matrix_from_quat
from artigen.types import Gaussians, Joint
from sim_export.motion.kinematics import link_displacements
from sim_export.package import HandleAnnotation, Hull, Link, Mesh, SimPackage, Visual
from sim_export.picture.view import GROUPS, PackageView, build_view, slider_scale, view_qpos


def _link(name: str, center: tuple[float, float, float]) -> Link:
    box = trimesh.creation.box(extents=(0.2, 0.2, 0.2))
    vertices = box.vertices + np.array(center)
    texture = np.full((4, 4, 3), 90, np.uint8)
    mesh = Mesh(vertices=vertices, faces=box.faces, uv=np.zeros((12, 3, 2)), texture=texture)
    visual = Visual(
        name=name,
        part=name,
        label="base",
        mesh=mesh if name == "link_0" else replace(mesh, uv=None, texture=None),
    )
    hull = Hull(vertices=vertices, faces=box.faces)
    return Link(name=name, label="base", parts=(name,), visuals=(visual,), hulls=(hull,), inertial=None)


@pytest.fixture(scope="module")
def package() -> SimPackage:
    """A chain: a hinged door with a knob that turns without limit, and a drawer."""
    joint = Joint(
        name="hinge", type="revolute", parent="body", child="link_0",
        origin=np.array([0.1, 0.4, 0.0]), axis=np.array([0.0, 0.0, -1.0]), upper=np.pi / 2,
    )  # fmt: skip
    handle = HandleAnnotation(
        link="link_0", part="link_0", width=0.02, clearance=0.03,
        corners=np.array(list(np.ndindex(2, 2, 2))) * 0.1,
        normal=np.array([-1.0, 0.0, 0.0]), grasp_line=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.1]]),
        opening_direction=np.array([-1.0, 0.0, 0.0]), gapart="hinge_handle",
    )  # fmt: skip
    return SimPackage(
        name="chain",
        category="StorageFurniture",
        visual="voxels",
        links=(
            _link("body", (0.5, 0.0, 0.0)),
            _link("link_0", (0.0, 0.2, 0.0)),
            _link("link_1", (-0.2, 0.1, 0.0)),
            _link("link_2", (0.0, -0.4, 0.3)),
        ),
        joints=(
            joint,
            replace(
                joint, name="knob", type="continuous", parent="link_0", child="link_1",
                origin=np.array([-0.2, 0.1, 0.05]), axis=np.array([-1.0, 0.0, 0.0]), upper=2.0 * np.pi,
            ),
            replace(
                joint, name="slide", type="prismatic", child="link_2",
                axis=np.array([-1.0, 0.0, 0.0]), upper=0.35,
            ),
        ),
        handles=(handle,),
    )  # fmt: skip


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture(scope="module")
def view(package: SimPackage) -> Iterator[PackageView]:
    view = build_view(package, port=free_port())
    yield view
    view.server.stop()


def settle(done: Callable[[], bool]) -> bool:
    """Waits for callbacks, which run in the server's threads."""
    for _ in range(400):
        if done():
            return True
        time.sleep(0.01)
    return False


def poses(view: PackageView, package: SimPackage, group) -> np.ndarray:
    T = np.tile(np.eye(4), (len(package.links), 1, 1))
    for index, link in enumerate(package.links):
        frame = view.frames[group, link.name]
        T[index, :3, :3] = matrix_from_quat(np.array(frame.wxyz))
        T[index, :3, 3] = frame.position
    return T


def shows(view: PackageView, package: SimPackage, qpos: dict[str, float]) -> bool:
    want = link_displacements(package.links, package.joints, qpos)
    return all(np.abs(poses(view, package, group) - want).max() < 1e-6 for group in GROUPS)


def test_the_page_is_served(view: PackageView):
    with urllib.request.urlopen(f"http://127.0.0.1:{view.server.get_port()}", timeout=10) as page:
        assert page.status == 200
        assert b"<html" in page.read(2000).lower()


def test_sliders_move_links_as_forward_kinematics_says(view: PackageView, package: SimPackage):
    assert list(view.sliders) == ["hinge", "knob", "slide"]
    assert "(deg)" in view.sliders["hinge"].label
    assert "(m)" in view.sliders["slide"].label
    assert view.sliders["hinge"].max == pytest.approx(90.0)
    assert view.sliders["slide"].max == pytest.approx(0.35)
    view.sliders["hinge"].value = 40.0
    view.sliders["knob"].value = -75.0
    view.sliders["slide"].value = 0.2
    qpos = {"hinge": np.radians(40.0), "knob": np.radians(-75.0), "slide": 0.2}
    assert settle(lambda: shows(view, package, qpos))
    assert view_qpos(view, package) == pytest.approx(qpos)
    assert not shows(view, package, qpos | {"knob": 0.0})


def test_buttons_open_and_close_everything(view: PackageView, package: SimPackage):
    press = {True: view.open_all, False: view.close_all}
    for opened in (True, False):
        press[opened].value = True
        qpos = {"hinge": np.pi / 2, "knob": np.pi / 2, "slide": 0.35} if opened else {}
        assert settle(lambda qpos=qpos: shows(view, package, qpos)), opened


def test_toggles_show_and_hide_their_group(view: PackageView):
    assert [view.branches[group].visible for group in GROUPS] == [True, False, False, False, False, False]
    for group in GROUPS:
        before = view.branches[group].visible
        view.toggles[group].value = not before
        assert settle(lambda group=group, before=before: view.branches[group].visible != before), group


def test_slider_units(package: SimPackage):
    assert [slider_scale(joint) for joint in package.joints] == pytest.approx([np.pi / 180, np.pi / 180, 1.0])


def test_gaussians_stand_beside_the_meshes_and_move_with_their_links(package: SimPackage):
    one = package.links[1].visuals[0].mesh.vertices
    splats = Gaussians(
        means=one,
        quats=np.tile([1.0, 0.0, 0.0, 0.0], (len(one), 1)),
        scales=np.full((len(one), 3), 0.01),
        opacities=np.ones(len(one)),
        colors=np.full((len(one), 3), 0.5),
        part_ids=np.ones(len(one), dtype=np.int64),
    )
    links = (package.links[0], replace(package.links[1], splats=splats), *package.links[2:])
    page = build_view(replace(package, links=links), port=free_port())
    try:
        assert page.branches["splats"].visible
        width = np.ptp(np.concatenate([link.visuals[0].mesh.vertices for link in links])[:, 1])
        assert page.branches["splats"].position[1] < -width
        page.sliders["hinge"].value = 45.0
        turned, beside = page.frames["visual", "link_0"], page.frames["splats", "link_0"]
        assert settle(lambda: abs(beside.wxyz[0]) < 0.99)
        np.testing.assert_allclose(beside.wxyz, turned.wxyz)
        np.testing.assert_allclose(beside.position, turned.position)
    finally:
        page.server.stop()
