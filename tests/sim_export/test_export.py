"""Laws of the export from voxels: textures come last and change nothing but the look of parts."""

from dataclasses import replace

import numpy as np
import pytest
from drawer_chest import make_chest

from artigen.shapes.asset import shape_to_asset
from artigen.types import Asset
from sim_export import export
from sim_export.collision.feet import Levelled
from sim_export.export import export_asset, export_solids, paint_package
from sim_export.geometry.hulls import box_hull
from sim_export.package import Mesh, SimPackage, Visual
from sim_export.search import HullPlan
from sim_export.solids import make_solids


@pytest.fixture(scope="module")
def chest() -> Asset:
    return shape_to_asset(make_chest(), 32, spacing=0.01)


def is_painted(visual: Visual) -> bool:
    """Whether a visual has a texture or, where it is all of one colour, this."""
    assert isinstance(visual.mesh, Mesh)
    return visual.mesh.texture is not None or visual.mesh.color != Mesh.color


def triangles(package: SimPackage) -> dict[str, np.ndarray]:
    """Corners of the faces of every visual, by its name."""
    found = {}
    for visual in (visual for link in package.links for visual in link.visuals):
        assert isinstance(visual.mesh, Mesh)
        found[visual.name] = visual.mesh.vertices[visual.mesh.faces]
    return found


def test_painting_keeps_shapes_and_what_is_not_of_a_part(chest: Asset):
    made = export_solids(make_solids(chest), HullPlan(target="voxels"))
    corner = box_hull(np.zeros(3), np.full(3, 0.01))
    foot = Visual(
        name="foot_0", part="body", label="base", mesh=Mesh(vertices=corner.vertices, faces=corner.faces)
    )
    body = made.package.links[-1]
    package = replace(
        made.package, links=(*made.package.links[:-1], replace(body, visuals=(*body.visuals, foot)))
    )
    painted = paint_package(package, chest, made.unpainted)
    before, after = triangles(package), triangles(painted)
    assert before.keys() == after.keys()
    for name, corners in before.items():
        np.testing.assert_allclose(after[name], corners, atol=1e-9)
    for visual in (visual for link in painted.links for visual in link.visuals):
        assert is_painted(visual) == (visual.name != "foot_0")


@pytest.mark.parametrize("collision", ["surfaces", "voxels"])
def test_feet_reach_up_to_the_surface_of_a_source_with_any_hulls(chest, monkeypatch, collision):
    surfaces = [mesh.vertices[mesh.faces] + 0.001 for mesh in make_solids(chest).meshes]
    seen = []

    def level(links, joints, requirements, category, shown):
        seen.append(shown)
        return Levelled(links=tuple(links))

    monkeypatch.setattr(export, "level_object", level)
    export_solids(make_solids(chest, surfaces), HullPlan(target=collision), source_meshes={})
    np.testing.assert_array_equal(seen[0], surfaces[chest.root])


def test_what_has_no_colours_stays_as_it_is(chest: Asset):
    made = export_solids(make_solids(chest), HullPlan(target="voxels"))
    assert paint_package(made.package, replace(chest, surface=None), made.unpainted) is made.package
    assert paint_package(made.package, chest, {}) is made.package


def test_an_exported_package_is_painted(chest: Asset):
    package = export_asset(chest).package
    assert all(is_painted(visual) for link in package.links for visual in link.visuals)
