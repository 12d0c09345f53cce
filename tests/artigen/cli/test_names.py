"""Names of packages: other words, other names; and no output of a run replaces another one."""

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import pytest

from artigen.api.generate import GenerateJob, GenerateSettings
from artigen.api.names import VALID, choose_name
from artigen.cli.usd import usd
from artigen.errors import ArtigenError
from artigen.shapes.draw import draw_shape
from artigen.weights import SHIPPED
from sim_export.files.write import write_package
from sim_export.reference import ReferenceConfig, build_reference

LONG = "a white fridge with black handles and a bottom freezer and two drawers below that are "
REQUESTS: tuple[tuple[str | None, str | None, str | None], ...] = (
    ("Oven", None, None),
    ("Oven", "a black one", None),
    (None, "a white fridge", None),
    (None, "two white fridges", None),
    (None, f"{LONG} red", None),
    (None, f"{LONG} blue", None),
    (None, None, "my kitchen.png"),
    ("Oven", None, "my kitchen.png"),
)


def key(category: str | None, text: str | None, image: str | None, seed: int = 0) -> str:
    cfg = GenerateSettings(text=text, image=None if image is None else Path(image))
    return GenerateJob(model=SHIPPED, category=category, seed=seed, out=Path(), cfg=cfg).key


def test_other_requests_and_seeds_have_other_names_that_folders_can_have():
    names = [key(*request, seed=seed) for request in REQUESTS for seed in (0, 1)]
    assert all(VALID.fullmatch(name) and len(name) < 100 for name in names)
    assert not any(one.lower() == other.lower() for one, other in combinations(names, 2))
    assert (names[0], names[4], names[12]) == ("Oven_0", "white_fridge_0", "my_kitchen_0")


def test_a_given_name_is_kept_and_several_have_their_seeds():
    assert [choose_name("fridge", seed, 1) for seed in (0, 7)] == ["fridge", "fridge"]
    assert [choose_name("fridge", seed, 2) for seed in (7, 8)] == ["fridge_7", "fridge_8"]
    assert choose_name(None, 0, 1) is None


@pytest.mark.parametrize("name", ["", "a/b", "..", ".hidden", "-x", "a b", "é"])
def test_a_name_that_no_folder_should_have_is_refused(name: str):
    with pytest.raises(ArtigenError, match="expected letters, digits"):
        choose_name(name, 0, 1)


@pytest.mark.parametrize("existing", ["refuse", "replace"])
def test_packages_of_one_name_become_several_assets(tmp_path: Path, capsys, existing):
    pytest.importorskip("pxr")
    made = build_reference(draw_shape("Switch", 0), ReferenceConfig())
    names = ("object_0", "Object_0", "object_0_2", "other")
    folders = [write_package(replace(made, name=name), tmp_path / f"in_{k}") for k, name in enumerate(names)]
    assert usd(tuple(folders), tmp_path / "usd", existing) == 0
    written = capsys.readouterr().out.split()
    assert len({path.lower() for path in written}) == len(names)
    assert all(Path(path).is_file() for path in written)
    with pytest.raises(ArtigenError, match="expected one package, got 4"):
        usd(tuple(folders), tmp_path / "usd", existing, name="x")
    assert usd((folders[0],), tmp_path / "usd", existing, name="White_Fridge") == 0
    assert (tmp_path / "usd" / "white_fridge" / "usd" / "white_fridge.usd").is_file()
