"""Surfaces of real objects: which triangles are one piece."""

import numpy as np
import pytest
import trimesh

from artigen.datasets.partnet_surface import FaceTable, split_pieces


def ball(x: float, *, welded: bool) -> FaceTable:
    """A ball of 1,280 triangles, whose vertices are shared or repeated for every triangle."""
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=0.1)
    mesh.apply_translation((x, 0.0, 0.0))
    corners = mesh.vertices[mesh.faces]
    faces = mesh.faces if welded else np.arange(corners.size // 3).reshape(-1, 3)
    return FaceTable(
        vertices=mesh.vertices if welded else corners.reshape(-1, 3),
        faces=faces,
        corners=corners,
        uv=np.zeros((*faces.shape, 2)),
        material_ids=np.zeros(len(faces), dtype=np.int64),
        materials=(),
    )


@pytest.mark.parametrize("welded", [True, False])
@pytest.mark.parametrize(("apart", "pieces"), [(0.23, 1), (0.25, 2)])
def test_pieces_are_told_apart_however_a_file_shares_vertices(apart: float, pieces: int, *, welded: bool):
    groups = split_pieces([ball(0.0, welded=welded), ball(apart, welded=welded)], 0.04)
    assert [set(group) for group in groups] == [{0}, {pieces - 1}]
