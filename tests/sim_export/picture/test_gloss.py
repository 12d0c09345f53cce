"""Laws of mirrored light: no more than arrives, as much as Fresnel says, sharper where smoother."""

import numpy as np
import pytest

from sim_export.picture.gloss import mirror_light, studio_light

UP = np.array([[0.0, 0.0, 1.0]])
FREE = np.array([[1.0, 0.0]])
SIDE = np.array([1.0, 0.0, 0.0])


def mirrored(
    rough: float, metal: float, head_on: float, eye: np.ndarray, visible=FREE, light=SIDE
) -> np.ndarray:
    albedo = np.full((len(eye), 3), 1.0)
    gloss = np.tile([rough, metal, head_on], (len(eye), 1))
    normals = np.repeat(UP, len(eye), axis=0)
    return mirror_light(albedo, gloss, normals, eye, light, np.repeat(visible, len(eye), axis=0))


def around(count: int) -> np.ndarray:
    """Directions from straight above to grazing."""
    angles = np.linspace(0.0, 0.49 * np.pi, count)
    return np.column_stack([np.sin(angles), np.zeros(count), np.cos(angles)])


@pytest.mark.parametrize("rough", [0.05, 0.3, 0.9])
def test_a_white_metal_mirrors_at_most_what_arrives_and_a_smooth_one_nearly_all(rough):
    eye = around(30)
    back = eye * [-1.0, 1.0, 1.0]
    arriving = studio_light(back, np.full((30, 1), rough))
    share = mirrored(rough, 1.0, 0.0, eye)[:, :1] / arriving
    assert share.max() <= 1.02
    assert share.min() > (0.9 if rough < 0.1 else 0.4)


@pytest.mark.parametrize("head_on", [0.02, 0.04, 0.2])
def test_a_smooth_dielectric_mirrors_head_on_what_fresnel_says_and_more_at_an_angle(head_on):
    eye = around(20)
    arriving = studio_light(eye * [-1.0, 1.0, 1.0], np.full((20, 1), 0.02))
    share = (mirrored(0.02, 0.0, head_on, eye)[:, :1] / arriving)[:, 0]
    assert share[0] == pytest.approx(head_on, abs=0.006)
    assert (np.diff(share) > 0).all()
    assert share[-1] > 0.5


def test_the_reflection_of_the_key_light_is_sharper_where_smoother():
    light = np.array([0.0, 0.0, 1.0])
    eye = around(40)
    for_all = {
        rough: (
            mirrored(rough, 1.0, 0.0, eye, np.array([[1.0, 1.0]]), light) - mirrored(rough, 1.0, 0.0, eye)
        )[:, 0]
        for rough in (0.2, 0.5)
    }
    assert for_all[0.2][0] > 3 * for_all[0.5][0]
    assert for_all[0.2][20] < for_all[0.5][20]


def test_what_stands_in_the_way_of_the_sky_and_of_the_light_is_not_mirrored():
    eye, light = around(3), np.array([0.0, 0.0, 1.0])
    open_, shut = (mirrored(0.2, 1.0, 0.0, eye, np.array([[share, 0.0]]), light) for share in (1.0, 0.0))
    np.testing.assert_allclose(shut, 0.25 * open_)
