"""Which closed surfaces V101 refuses."""

import numpy as np
import pytest
import trimesh

from artigen.files.wavefront import ObjText
from sim_export.checks.config import CheckConfig
from sim_export.checks.geometry import count_open_edges, mesh_faults
from sim_export.checks.subject import Shape


def shape(vertices: np.ndarray, faces: np.ndarray) -> Shape:
    """A visual mesh."""
    nothing = np.zeros(0, dtype=np.int64)
    text = ObjText(
        vertices=vertices, coords=np.zeros((0, 2)), faces=faces, uv_faces=np.full_like(faces, -1),
        names=("",), material_ids=nothing, libraries=(),
    )  # fmt: skip
    return Shape(link="body", name="", kind="mesh", file="a.obj", vertices=vertices, faces=faces, obj=text)


def chain(solid: trimesh.Trimesh, count: int) -> Shape:
    """Copies of a solid in a row, each of which ends in the corner where the next begins."""
    vertices = np.asarray(solid.vertices)
    first, last = vertices[:, 0].argmin(), vertices[:, 0].argmax()
    points, faces, held = [vertices], [np.asarray(solid.faces)], int(last)
    for index in range(1, count):
        number = np.arange(len(vertices)) + index * len(vertices)
        number[first] = held
        held = int(number[last])
        points.append(vertices + index * (vertices[last] - vertices[first]))
        faces.append(number[solid.faces])
    return shape(np.concatenate(points), np.concatenate(faces))


@pytest.mark.parametrize(("solid", "count", "fault"), [
    (trimesh.creation.icosphere(subdivisions=1), 1, ""),
    (trimesh.creation.torus(1.0, 0.3, major_sections=12, minor_sections=6), 1, ""),
    (trimesh.creation.icosphere(subdivisions=1), 3, "Euler number 4"),
    (trimesh.creation.torus(1.0, 0.3, major_sections=12, minor_sections=6), 2, "Euler number -1"),
])  # fmt: skip
def test_solids_that_share_one_corner_are_no_closed_surface(solid, count, fault):
    """Although every edge has two faces: each of them has an Euler number of 2, or of 0 with a hole."""
    row = chain(solid, count)
    assert count_open_edges(row.faces) == 0
    faults = mesh_faults(row, CheckConfig())
    assert len(faults) == (1 if fault else 0)
    assert fault in " ".join(faults)


@pytest.mark.parametrize("lost", [None, 0, 40, 130])
def test_bodies_joined_at_a_corner_pass_and_one_that_lacks_a_face_does_not(lost):
    row = chain(trimesh.creation.icosphere(subdivisions=1), 2)
    faces = row.faces if lost is None else np.delete(row.faces, lost, axis=0)
    faults = mesh_faults(shape(row.vertices, faces), CheckConfig(), joined=True)
    assert faults == ([] if lost is None else ["is open or wound inconsistently along 3 edges"])


@pytest.mark.parametrize("turned", [0, 1])
def test_of_joined_bodies_none_may_be_turned_inside_out(turned):
    """Their sum encloses more than nothing where the other one is larger."""
    balls = [trimesh.creation.icosphere(subdivisions=1, radius=size) for size in (1.0, 0.5)]
    balls[1].apply_translation((3.0, 0.0, 0.0))
    balls[turned].invert()
    both = trimesh.util.concatenate(balls)
    faults = mesh_faults(shape(np.asarray(both.vertices), np.asarray(both.faces)), CheckConfig(), joined=True)
    assert "wound inwards" in " ".join(faults)


@pytest.mark.parametrize("inward", [False, True])
def test_a_surface_whose_vertices_are_split_along_seams_is_judged_like_the_whole_one(inward):
    """Files repeat corners where the texture is cut; here every triangle has its own."""
    solid = trimesh.creation.icosphere(subdivisions=1)
    corners = np.asarray(solid.triangles)[:, ::-1] if inward else np.asarray(solid.triangles)
    split = shape(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    assert bool(mesh_faults(split, CheckConfig())) is inward
