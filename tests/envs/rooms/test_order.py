"""Rooms on order hold the ordered units from left to right and nothing else, or say why they cannot."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from box_furniture import Furniture, write_proven
from sample_packages import SAMPLE_PARTS, build_package

from artigen.api.scene import SceneSettings, furnish_room, read_places
from artigen.errors import ArtigenError
from envs.rooms.catalogue import Catalogue, Entry
from envs.rooms.check import check_room
from envs.rooms.order import SLIPS, least_length, read_order
from envs.rooms.populate import PopulateConfig, populate
from envs.rooms.room import SIDES, YAWS, pose_matrix_of
from sim_export.files.write import write_package

ROLES = {"fridge": "Refrigerator", "range": "Oven", "base cabinet": "StorageFurniture"}
SIZES = {"Refrigerator": (0.6, 0.6, 1.7), "Oven": (0.6, 0.6, 0.9), "StorageFurniture": (0.6, 0.81, 0.88)}
HANGS = (0.4, 0.81, 0.7)
"""Size (m) at which the sample cabinet may hang."""


@pytest.fixture(scope="module")
def catalogue(tmp_path_factory: pytest.TempPathFactory) -> Catalogue:
    """The sample cabinet under the name and size of each kind."""
    base = tmp_path_factory.mktemp("order").resolve()
    entries = []
    for kind, size in SIZES.items():
        folder = write_package(replace(build_package(SAMPLE_PARTS), category=kind), base / kind)
        entries.append(
            Entry(folder=folder, name=kind, category=kind, size=size, kinds=("revolute",), provenance=())
        )
    entries.append(replace(entries[-1], name="Hung", size=HANGS))
    return Catalogue(folder=base, entries=tuple(entries), failed=())


@pytest.mark.parametrize("side", SIDES)
def test_units_stand_from_left_to_right_as_ordered_and_open(catalogue: Catalogue, side):
    words = ("oven", "cupboard:0.8", "fridge", "cupboard")
    cfg = PopulateConfig(width=5.0, depth=5.0, place=words, wall=side)
    room = populate("kitchen", 3, catalogue, cfg)
    assert [p.role for p in room.placements] == ["base cabinet", "fridge", "base cabinet", "range"]
    facing = np.array([np.cos(YAWS[side]), np.sin(YAWS[side])])  # into the wall
    left = np.array([-facing[1], facing[0]])
    along = {p.id: float(left @ pose_matrix_of(p)[:2, 3]) for p in room.placements}
    seen = [room.placement(name).role for name in sorted(along, key=lambda name: -along[name])]
    assert seen == ["range", "base cabinet", "fridge", "base cabinet"]
    assert not check_room(room)


@pytest.mark.parametrize("side", SIDES)
def test_a_length_stays_free_and_what_is_above_hangs_over_the_left_end(catalogue: Catalogue, side):
    words = ("cupboard@StorageFurniture", "1.2", "oven", "above", "0.1", "wall cabinet@Hung")
    room = populate("kitchen", 3, catalogue, PopulateConfig(width=5.5, depth=5.5, place=words, wall=side))
    assert [p.role for p in room.placements] == ["base cabinet", "range", "wall cabinet"]
    facing = np.array([np.cos(YAWS[side]), np.sin(YAWS[side])])
    along = [float(np.array([facing[1], -facing[0]]) @ pose_matrix_of(p)[:2, 3]) for p in room.placements]
    wide = room.placements[0].size[1]
    assert along[1] - along[0] == pytest.approx(wide + 1.2, abs=0.01)
    assert 0.09 <= along[2] - along[0] <= 0.1 + SLIPS[-1] + 0.01
    low = [p.position[2] - room.placements[0].position[2] for p in room.placements]
    assert low[1] == pytest.approx(0.0)
    assert low[2] > 1.2
    assert not check_room(room)


def test_a_named_package_is_the_one_that_stands_there(catalogue: Catalogue):
    other = replace(catalogue.entries[2], name="Other")
    held = replace(catalogue, entries=(*catalogue.entries, other))
    words = ("cupboard@Other", "cupboard@StorageFurniture")
    order = read_order(words, "kitchen")
    assert [[entry.name for entry in held.entries if unit.accepts(entry)] for unit in order] == [
        ["Other"], ["StorageFurniture"],
    ]  # fmt: skip
    with pytest.raises(ArtigenError, match="nothing in it can be the ordered base cabinet"):
        populate("kitchen", 0, held, PopulateConfig(place=("cupboard@Missing",)))


def test_synonyms_and_nouns_mean_one_role():
    words = ("fridge", "refrigerator", "pantry", "oven", "stove", "dishwasher", "sink:0.8", "base_cabinet")
    roles = [unit.role.name for unit in read_order(words, "kitchen")]
    assert roles == ["fridge", "fridge", "larder", "range", "range", "dishwasher", "sink", "base cabinet"]
    assert read_order(("sink:0.8",), "kitchen")[0].width == 0.8


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("unicorn",), "has no 'unicorn', expected one of cart, bin, fridge"),
        (("fridge:9",), "0.45 to 1.4 m wide"),
        (("fridge:wide",), "width 'wide' m"),
        (("fridge:nan",), "width 'nan' m"),
        (("above", "wall cabinet"), "nothing stands below what hangs"),
        (("fridge", "above", "oven"), "no 'oven' on its walls, expected one of wall cabinet"),
        (("fridge", "9", "fridge"), "2 units take at least"),
        (("fridge",) * 20, "20 units take at least"),
        (("20*fridge",), "20 units take at least"),
        (("many*fridge",), "'many' units"),
        (("missing.yaml",), "cannot be read"),
    ],
)
def test_what_cannot_be_is_said_before_anything_is_made(words: tuple[str, ...], said: str, tmp_path: Path):
    with pytest.raises(ArtigenError, match=said):
        furnish_room("kitchen", tmp_path / "room", 0, None, SceneSettings(place=words))
    assert not (tmp_path / "room").exists()


def test_a_width_that_no_package_has_is_refused(catalogue: Catalogue):
    with pytest.raises(ArtigenError, match=r"fridge 0\.9 m wide; widths of what can be one are 0\.60"):
        populate("kitchen", 0, catalogue, PopulateConfig(place=("fridge:0.9",)))


def test_the_least_length_is_that_of_the_widths():
    order = read_order(("fridge:0.6", "sink:0.8"), "kitchen")
    assert least_length(order) == pytest.approx(1.4, abs=0.02)


def test_units_may_be_one_word_with_commas():
    assert read_places(("fridge, sink:0.8,2*oven",)) == ("fridge", "sink:0.8", "2*oven")


def test_numbers_and_files_list_units(tmp_path: Path):
    (tmp_path / "order.yaml").write_text("- fridge\n- 2*cupboard:0.6\n- 'oven'\n")
    words = read_places(("sink", str(tmp_path / "order.yaml")))
    units = read_order(words, "kitchen")
    assert [unit.role.name for unit in units] == ["sink", "fridge", "base cabinet", "base cabinet", "range"]
    (tmp_path / "wrong.yaml").write_text("units: 3\n")
    with pytest.raises(ArtigenError, match="expected a list of units"):
        read_places((str(tmp_path / "wrong.yaml"),))


def test_packages_stand_in_their_order_or_it_is_said_which_does_not_open(
    catalogue: Catalogue, tmp_path: Path
):
    plain = Furniture(name="plain", category="StorageFurniture", size=(0.6, 0.6, 0.88), doors=1)
    low = Furniture(name="low", category="Crate", size=(0.35, 0.6, 0.3), doors=1, swing=2.6)
    deep = Furniture(name="deep", category="StorageFurniture", size=(1.1, 0.6, 0.88))
    paths = {each.name: str(write_proven(each, tmp_path)) for each in (plain, low, deep)}

    def place(*names: str) -> list[str]:
        cfg = PopulateConfig(width=4.0, depth=4.0, place=tuple(paths[name] for name in names))
        return [entry.package.name for entry in populate("kitchen", 0, catalogue, cfg).placements]

    assert place("plain", "plain", "deep", "plain") == ["plain", "deep", "plain", "plain"]
    (tmp_path / "list.yaml").write_text("- low\n- plain\n")
    assert read_places((str(tmp_path / "list.yaml"),)) == (paths["low"], paths["plain"])
    reasons = []
    for names in (("low", "deep"), ("deep", "low")):
        try:
            place(*names)
        except ArtigenError as error:
            reasons.append(str(error))
    assert len(reasons) == 1
    assert "the crate does not open beside the" in reasons[0]
    bad = write_proven(plain, tmp_path / "bad", "fail")
    with pytest.raises(ArtigenError, match="failed V203"):
        read_order((str(bad),), "kitchen")
