"""Looks, friction and masses at reset: others for every episode, the same for the same seed."""

import gymnasium as gym
import numpy as np
import pytest

import artigen
import envs  # noqa: F401  registers the tasks
from envs.randomize import read_randomization
from envs.sim.looks import find_materials
from envs.sim.sapien import LoadConfig, load_package
from envs.sim.scene import create_scene, has_render_device
from sim_export.package import Mesh

drawn = pytest.mark.skipif(not has_render_device(), reason="needs a render device")


@pytest.fixture(scope="module")
def cabinet(tmp_path_factory):
    obj = artigen.sample("StorageFurniture", 0, counts={"drawer": 1, "door": 1})
    return obj.export(tmp_path_factory.mktemp("looks") / "cabinet")


def make(cabinet, **options):
    return gym.make(
        "ArtiGen-OpenPart-v1", packages=str(cabinet.folder), part="drawer", validation="any",
        obs_mode="state", sim_backend="physx_cpu", **options,
    )  # fmt: skip


def colors(env) -> dict[str, tuple]:
    (articulation,) = env.unwrapped.built
    found = find_materials(articulation._objs[0].links)
    return {name: (*material.base_color, material.roughness, material.metallic) for name, material in found}


@drawn
def test_sapien_reads_the_materials_of_a_package(cabinet):
    scene = create_scene(0.01, ground=False, render=True)
    loaded = load_package(scene, cabinet.folder, LoadConfig(visuals="all"))
    read = dict(find_materials(loaded.articulation.links))
    for visual in (visual for link in cabinet.package.links for visual in link.visuals):
        assert isinstance(visual.mesh, Mesh)
        look, material = visual.mesh.material, read[visual.name]
        color = np.ones(3) if visual.mesh.texture is not None else visual.mesh.color
        np.testing.assert_allclose(material.base_color, [*color, look.opacity], atol=1e-6)
        assert material.roughness == pytest.approx(look.roughness)
        assert material.metallic == pytest.approx(look.metallic)
        assert (material.base_color_texture is None) == (visual.mesh.texture is None)


@drawn
def test_every_reset_shows_another_look_and_a_seed_repeats_its_own(cabinet):
    env = make(cabinet, render_backend="cpu", randomize={"looks": True})
    seen = []
    for seed in (1, 2, None, 1):
        env.reset(seed=seed)
        seen.append(colors(env))
    assert seen[0] == seen[3]
    assert seen[0] != seen[1] != seen[2]


def test_a_scene_that_does_not_render_has_no_looks(cabinet):
    with pytest.raises(ValueError, match="cannot render, so it has no looks"):
        make(cabinet, render_backend="none", randomize={"looks": True})


def physics(env) -> dict[str, tuple[float, float]]:
    """Friction of every joint and mass of its link, by the package's names."""
    (articulation,) = env.unwrapped.built
    joints = [joint for engine in articulation._objs for joint in engine.active_joints]
    return {
        joint.name.rsplit("_", 2)[-2] + "_" + joint.name.rsplit("_", 1)[-1]: (
            joint.force_limit, joint.child_link.mass,
        )
        for joint in joints
    }  # fmt: skip


def test_friction_and_masses_are_drawn_within_their_ranges_and_repeat_with_the_seed(cabinet):
    plain = make(cabinet, render_backend="none")
    plain.reset(seed=0)
    own = physics(plain)
    env = make(cabinet, render_backend="none", randomize={"friction": (2.0, 3.0), "mass": (0.5, 0.9)})
    seen = []
    for seed in (1, 2, 1):
        env.reset(seed=seed)
        seen.append(physics(env))
        for name, (friction, mass) in seen[-1].items():
            assert 2.0 <= friction / own[name][0] <= 3.0
            assert 0.5 <= mass / own[name][1] <= 0.9
    assert seen[0] == seen[2] != seen[1]


@pytest.mark.parametrize("wrong", [{"mass": (0.0, 1.0)}, {"friction": (2.0, 1.0)}, {"weight": (1.0, 2.0)}])
def test_what_cannot_be_drawn_is_refused(wrong):
    with pytest.raises(
        ValueError, match=r"mass 0.0 to 1.0|friction 2.0 to 1.0|has weight, expected friction"
    ):
        read_randomization(wrong)
