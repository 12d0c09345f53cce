"""A kind that is added in a file of its own goes all the way, and no other product file names a kind."""

import ast
import re
import shutil
from dataclasses import fields
from pathlib import Path

import pytest
from extension import EXTENSION, install_extension
from project import ROOT

import artigen.kinds
from artigen.conditioning.read import read_sentence
from artigen.errors import ArtigenError
from artigen.kind import Kind, find_kind, forget, kinds, list_words, paper_kinds
from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.families import choose_suite, dress_shape, wish_suite
from artigen.sketch.understand import Request, understand
from envs.rooms.catalogue import read_catalogue
from envs.rooms.recipes import RECIPES, Role
from sim_export.files.write import write_package
from sim_export.reference import build_reference
from sim_export.report import Report, write_report

NAME = "CardIndex"


@pytest.fixture(params=["file", "extension"])
def card_index(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The kind, in a file of its own, or of a distribution."""
    if request.param == "file":
        folder = tmp_path / "kinds"
        shutil.copytree(EXTENSION / "artigen_card_index", folder / "card_index")
        monkeypatch.setattr(artigen.kinds, "__path__", [*artigen.kinds.__path__, str(folder)])
    else:
        install_extension(monkeypatch, tmp_path)
    forget()
    yield kinds()[NAME]
    monkeypatch.undo()
    forget()
    assert NAME not in kinds()


def _write_passed(folder: Path) -> Path:
    shape = draw_shape(NAME, 3, Wish(width=0.4))
    path = write_package(build_reference(shape), folder / shape.name)
    from envs.worker import run_static

    checks = run_static(path)
    assert [(check.id, check.message) for check in checks if check.verdict == "fail"] == []
    write_report(Report(package=path.name, checks=checks), path / "validation.json")
    return path


def test_an_added_kind_goes_from_a_sentence_to_a_room_and_a_file(card_index: Kind, tmp_path: Path):
    said = read_sentence("two archive card indexes, oak, 40 cm wide, with brass handles")
    assert (said.kind, said.style, dict(said.size)) == (NAME, "library", {"width": 0.4})
    assert list_words()[-1] == NAME
    assert paper_kinds() == list_words()[:7]
    with pytest.raises(ArtigenError, match=f"artigen shape {NAME}` draws it"):
        understand(Request(text="a card index"))  # until a network is trained with it
    suite = choose_suite("shaker", 1)
    dressed = dress_shape(draw_shape(NAME, 0, wish_suite(NAME, suite)), suite)
    assert dict(dressed.finishes)["front"].color == suite.finishes["furniture"]["front"].color
    path = _write_passed(tmp_path)
    assert "card_index_body" in (path / "semantics.txt").read_text()
    (entry,) = read_catalogue(tmp_path).of_role(Role("crate"))
    assert entry.category == NAME
    assert NAME in Role("crate").categories
    assert (NAME, (0.0, 0.0, 0.0)) in Role("crate").draws


def test_an_added_kind_is_exported_to_openusd_with_its_code(card_index: Kind, tmp_path: Path):
    usd = pytest.importorskip("pxr.Usd")
    from sim_export.usd.write import write_usd

    main = write_usd(build_reference(draw_shape(NAME, 0)), tmp_path)
    stage = usd.Stage.Open(str(main))
    labels = stage.GetDefaultPrim().GetAttribute("semantics:labels:wikidata_qcode").Get()
    assert list(labels) == [card_index.wikidata]


@pytest.mark.sim
def test_an_added_kind_is_opened_in_a_task(card_index: Kind, tmp_path: Path):
    gym = pytest.importorskip("gymnasium")
    pytest.importorskip("mani_skill")
    import envs  # noqa: F401  registers the tasks

    env = gym.make(
        "ArtiGen-OpenPart-v1", packages=str(_write_passed(tmp_path)), part="drawer", obs_mode="state",
        sim_backend="physx_cpu", render_backend="none", validation="any",
    )  # fmt: skip
    env.reset(seed=0)
    task = env.unwrapped
    qpos = task.object.get_qpos().clone()  # pyright: ignore[reportAttributeAccessIssue]
    qpos[task._rows, task._columns] = task._lower + task._span  # pyright: ignore[reportAttributeAccessIssue]
    task.object.set_qpos(qpos)  # pyright: ignore[reportAttributeAccessIssue]
    assert task.evaluate()["success"]  # pyright: ignore[reportAttributeAccessIssue]
    env.close()


def test_a_record_without_a_fact_cannot_be_constructed():
    whole = {field.name: getattr(kinds()["Toaster"], field.name) for field in fields(Kind)}
    assert Kind(**whole) == kinds()["Toaster"]
    for name in whole:
        with pytest.raises(TypeError, match=name):
            Kind(**{key: value for key, value in whole.items() if key != name})
    with pytest.raises(ValueError, match=r"styles gothic are not listed, expected .*retro"):
        Kind(**{**whole, "style_words": {"medieval": "gothic"}})


def test_words_of_shipped_networks_keep_their_numbers():
    numbered = {kind.word: name for name, kind in kinds().items()}
    assert list_words() == tuple(numbered[number] for number in range(30))
    assert list_words()[:9] == (
        "StorageFurniture", "Table", "Refrigerator", "Dishwasher", "Oven", "WashingMachine", "Microwave",
        "Cart", "Safe",
    )  # fmt: skip
    assert list(list_words()[9:]) == sorted(list_words()[9:])
    assert find_kind("KitchenPot") is kinds()["Pot"]


def test_a_noun_names_one_kind_and_roles_of_rooms_have_a_kind():
    nouns = [noun for kind in kinds().values() for noun in kind.nouns]
    assert len(nouns) == len(set(nouns))
    roles = {role.name for recipe in RECIPES.values() for role in recipe.all_roles}
    assert roles == {place.role for kind in kinds().values() for place in kind.places}


def test_no_product_file_outside_the_folder_of_kinds_names_a_kind():
    names, found = set(kinds()), []
    for path in sorted(
        file for part in ("artigen", "sim_export", "envs") for file in (ROOT / part).rglob("*.py")
    ):
        if path.is_relative_to(ROOT / "artigen" / "kinds"):
            continue
        text = path.read_text()
        if not (names & set(re.findall(r"[A-Za-z]+", text)) or "artigen.kinds" in text):
            continue
        tree = ast.parse(text)
        said = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}  # docstrings
        for node in ast.walk(tree):
            where = f"{path.relative_to(ROOT)}:{getattr(node, 'lineno', 0)}"
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in said:
                found += [f"{where} {name}" for name in names & set(re.findall(r"[A-Za-z]+", node.value))]
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("artigen.kinds"):
                found.append(f"{where} imports {node.module}")
    assert found == []
