"""Other looks: only colours change, and the same seed gives the same."""

import pytest

import artigen
from artigen.errors import ArtigenError
from sim_export.errors import PackageError
from sim_export.files.write import package_files
from sim_export.package import SimPackage

LOOKS = (".mtl", ".png", "materials.json", "manifest.json", "mobility.mjcf.xml")


def looks(package: SimPackage) -> list[tuple]:
    return [(v.finish, v.look, v.mesh.color) for link in package.links for v in link.visuals]


@pytest.fixture(scope="module")
def cabinet():
    return artigen.sample("StorageFurniture", 3)


def test_only_what_says_how_it_looks_changes(cabinet):
    before, after = package_files(cabinet.package), package_files(artigen.restyle(cabinet, 5).package)
    changed = {path for path in before.keys() | after.keys() if before.get(path) != after.get(path)}
    assert any(path.endswith(".mtl") for path in changed)
    for path in changed:
        if path.endswith(".obj"):  # names of materials
            one, other = (
                [line for line in files[path].splitlines() if not line.startswith((b"mtllib", b"usemtl"))]
                for files in (before, after)
            )
            assert one == other
        else:
            assert path.endswith(LOOKS)


def test_a_seed_gives_one_look_and_seeds_give_many(cabinet):
    first, again = (looks(artigen.restyle(cabinet, 7).package) for _ in range(2))
    assert first == again
    assert len({tuple(looks(artigen.restyle(cabinet, seed).package)) for seed in range(12)}) > 9
    worn = artigen.restyle(cabinet, 7)
    assert worn.shape is not None
    assert dict(worn.shape.finishes).keys() == dict(cabinet.shape.finishes).keys()


def test_visuals_of_one_material_look_the_same_and_clear_panes_stay_clear():
    oven = artigen.sample("Oven", 1)
    for seed in range(6):
        package = artigen.restyle(oven, seed).package
        seen: dict[str, tuple] = {}
        for visual in (visual for link in package.links for visual in link.visuals):
            key = (visual.mesh.color, visual.mesh.material)
            assert seen.setdefault(visual.look, key) == key
        clear, still = (
            [v.mesh.material.opacity < 1 for link in p.links for v in link.visuals]
            for p in (oven.package, package)
        )
        assert clear == still


def test_errors_name_what_is_there_and_what_is_allowed(cabinet):
    with pytest.raises(ArtigenError, match="style 'odd' is not known, expected one of"):
        artigen.restyle(cabinet, 0, style="odd")
    from artigen.shapes.asset import shape_to_asset
    from sim_export.export import export_asset

    rebuilt = export_asset(shape_to_asset(cabinet.shape)).package
    plain = artigen.api.object.Object(name="a", kind=cabinet.kind, build=lambda: rebuilt)
    with pytest.raises(PackageError, match="its visuals show the finishes none"):
        assert artigen.restyle(plain).package
