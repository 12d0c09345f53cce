"""Laws of sets of one topology: variants share it and differ in size, other builds have another one."""

from dataclasses import replace

import numpy as np
import pytest
from braced_cabinet import with_link

from artigen.api.sample import ShapeSettings, choose_like, sample_packages
from artigen.api.sets import group_packages
from artigen.errors import ArtigenError
from artigen.runtime.runner import LocalRunner
from artigen.shapes.draw import ShapeError, Wish, draw_shape, draw_variant, find_seed
from artigen.shapes.shape import Shape
from sim_export.files.folders import find_packages
from sim_export.files.read import read_package
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull, clip_hull
from sim_export.geometry.primitives import is_box
from sim_export.package import SimPackage
from sim_export.reference import build_reference, describe_build
from sim_export.topology import find_topology

HERE = LocalRunner(workers=0)


def variants(category: str, like: int, count: int, wish: Wish | None = None) -> list[Shape]:
    build = describe_build(draw_shape(category, like, wish))
    return [
        draw_variant(category, like, seed, lambda shape: describe_build(shape) == build, wish)
        for seed in range(count)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("category", ["Microwave", "Table", "Safe"])
def test_variants_share_names_joints_and_kinds_of_hulls(category):
    one = build_reference(draw_shape(category, 3))
    shapes = variants(category, 3, 3)
    others = [build_reference(shape) for shape in shapes]
    assert {find_topology(package) for package in others} == {find_topology(one)}
    for package in others:
        assert [link.name for link in package.links] == [link.name for link in one.links]
        assert [len(link.hulls) for link in package.links] == [len(link.hulls) for link in one.links]
        assert [(j.name, j.type, j.parent) for j in package.joints] == [
            (j.name, j.type, j.parent) for j in one.joints
        ]
    sizes = {tuple(np.round(np.subtract(*shape.bounds()[::-1]), 4)) for shape in shapes}
    assert len(sizes) == 3


def test_a_variant_depends_on_its_seeds_alone_and_keeps_wishes():
    wish = Wish(width=0.45, counts=(("drawer", 2),))
    first, second = variants("FilingCabinet", 1, 1, wish)[0], variants("FilingCabinet", 1, 1, wish)[0]
    assert [p.primitives[0].center.tolist() for p in first.parts] == [
        p.primitives[0].center.tolist() for p in second.parts
    ]
    assert sum(part.label == "drawer" for part in first.parts) == 2
    low, high = first.bounds()
    assert high[1] - low[1] == pytest.approx(0.45, abs=0.02)


def test_what_nothing_fits_is_an_error():
    with pytest.raises(ShapeError, match="none of 100 variants of seed 3 by seed 0"):
        draw_variant("Microwave", 3, 0, lambda shape: False)


def test_the_first_seed_with_the_parts_is_found():
    counts = (("drawer", 2), ("door", 0))
    seed = find_seed("StorageFurniture", counts)
    held = [dict(draw_shape("StorageFurniture", k).condition.counts) for k in range(seed + 1)]
    assert [k for k in range(seed + 1) if held[k].get("drawer", 0) == 2 and "door" not in held[k]] == [seed]


def test_the_last_seed_that_is_searched_counts():
    counts = (("drawer", 2), ("door", 0))
    seed = find_seed("StorageFurniture", counts)
    assert find_seed("StorageFurniture", counts, most=seed + 1) == seed
    with pytest.raises(ShapeError, match=f"none of {seed} seeds has 2 drawer, 0 door; most frequent were"):
        find_seed("StorageFurniture", counts, most=seed)


def test_parts_can_be_asked_for_in_place_of_a_seed(tmp_path):
    settings = ShapeSettings(topology=("drawer=0", "door=1"), width=0.5, validation="none")
    assert choose_like("Safe", settings).like == 0
    assert all(one.good for one in sample_packages("Safe", tmp_path, range(2), settings, runner=HERE))
    packages = [read_package(folder) for folder in find_packages([tmp_path])]
    assert len(packages) == 2
    assert len({find_topology(package) for package in packages}) == 1


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        (ShapeSettings(topology=("door=1",), like=0), "topology door=1 beside like 0"),
        (ShapeSettings(topology=("door=1",), counts=("drawer=0",)), "topology door=1 beside counts drawer=0"),
        (ShapeSettings(topology=("gates=1",)), "count 'gates=1' is not of the form"),
    ],
)
def test_a_topology_that_contradicts_itself_is_refused(settings, says):
    with pytest.raises(ArtigenError, match=says):
        choose_like("Safe", settings)


def changed_hull(package: SimPackage) -> SimPackage:
    cut = clip_hull(box_hull(np.zeros(3), np.ones(3)), np.array([0.6, 0.0, 0.8]), 0.9)
    assert cut is not None
    link = next(link for link in package.links if any(map(is_box, link.hulls)))
    hulls = tuple(cut if is_box(hull) else hull for hull in link.hulls)
    return with_link(package, link.name, hulls=hulls)


def fewer_hulls(package: SimPackage) -> SimPackage:
    link = max(package.links, key=lambda link: len(link.hulls))
    return with_link(package, link.name, hulls=link.hulls[1:])


def other_joint(package: SimPackage) -> SimPackage:
    first, *rest = package.joints
    return replace(package, joints=(replace(first, name="joint_9"), *rest))


def other_order(package: SimPackage) -> SimPackage:
    return replace(package, joints=package.joints[::-1])


@pytest.mark.parametrize("change", [changed_hull, fewer_hulls, other_joint, other_order])
def test_what_a_batch_cannot_mix_has_another_topology(change):
    package = build_reference(draw_shape("Safe", 0))
    assert find_topology(change(package)) != find_topology(package)


def test_numbers_and_materials_do_not_matter():
    package = build_reference(draw_shape("Safe", 0))
    joints = tuple(replace(joint, upper=0.5 * joint.upper, friction=9.0) for joint in package.joints)
    assert find_topology(replace(package, joints=joints, name="other", materials=())) == find_topology(
        package
    )


@pytest.mark.slow
def test_files_say_it_and_sets_are_found_at_any_depth(tmp_path):
    for place, drawn in (("a", draw_shape("Safe", 0)), ("b/c", draw_shape("Microwave", 3))):
        write_package(build_reference(drawn), tmp_path / place / "one")
    for index, drawn in enumerate(variants("Microwave", 3, 2)):
        write_package(build_reference(drawn), tmp_path / "b" / f"variant_{index}")
    folders = find_packages([tmp_path])
    assert len(folders) == 4
    assert find_packages([folders[0], tmp_path / "b"]) == folders
    package = read_package(folders[0])
    assert f'"topology": "{find_topology(package)}"' in (folders[0] / "meta.json").read_text()
    (found,) = (one for one in group_packages([tmp_path]) if len(one.folders) > 1)
    assert len(found.folders) == 3
    assert found.what.startswith("Microwave")
    for missing in (tmp_path / "none", tmp_path / "b" / "variant_0" / "visual"):
        with pytest.raises(ArtigenError, match=missing.name):
            find_packages([missing])
    journal = tmp_path / "run.jsonl"
    journal.touch()
    assert find_packages(sorted(tmp_path.iterdir())) == folders
    for nothing in ([], journal):
        with pytest.raises(ArtigenError, match="expected the folder of a package"):
            find_packages(nothing)
