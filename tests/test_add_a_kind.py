"""A kind that is added in a file of its own goes all the way, and no other product file names a kind."""

import ast
import re
from dataclasses import fields
from pathlib import Path

import pytest
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
SOURCE = '''
"""CardIndex: a box with one drawer for cards."""

import numpy as np

from artigen.kind import Kind, Place, by_width, make, plurals
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose_style
from artigen.shapes.draw import Draft, choose_size
from artigen.shapes.fittings.hardware import slide
from artigen.shapes.primitives import block
from artigen.shapes.ranges import around, margins, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette

STYLES = {"desktop": 2.0, "library": 1.0}


def draw(rng, wish):
    style = choose_style(rng, STYLES, wish.style)
    width, depth, height = choose_size(
        rng, "CardIndex", wish, ((0.3, 0.45), (0.35, 0.48), (0.18, 0.3))
    )
    x, y, z, wall, gap = (0.02 - depth / 2, depth / 2), around(0.0, width / 2), (0.0, height), 0.015, 0.003
    inner, room = narrow(y, wall), (wall, height - wall)
    body = [
        *(block(x, side, z, "body") for side in margins(y, wall)),
        *(block(x, inner, level, "body") for level in margins(z, wall)),
        block((x[1] - wall, x[1]), inner, room, "body"),
    ]
    box, low = narrow(inner, gap), (room[0] + gap, room[0] + gap + 0.008)
    deep, high = (x[0], x[1] - wall - gap), (low[0], room[1] - 0.03)
    drawer = [
        block(deep, box, low, "drawer"),
        *(block(deep, side, high, "drawer") for side in margins(box, 0.008)),
        block((deep[1] - 0.008, deep[1]), narrow(box, 0.008), high, "drawer"),
        block((x[0], x[0] + 0.012), box, (low[0], room[1] - gap), "front"),
    ]
    pull = block((x[0] - 0.02, x[0]), around(0.0, 0.02), around(height / 2, 0.01), "handle")
    parts = [
        ShapePart("drawer", "drawer", drawer, slide(0.6 * depth)),
        ShapePart("pull", "handle", (pull,), parent="drawer"),
    ]
    return Draft(style, Assembly(body, parts).close(), draw_palette(rng, "furniture", style))


KIND = Kind(
    name="CardIndex",
    nouns=plurals("card index", "card catalogue"),
    hints=(),
    size=(by_width(0.4),),
    deepest=np.inf,
    diagonal=(0.3, 1.0),
    build="board",
    stands="free",
    styles=tuple(STYLES),
    style_words={"archive": "library"},
    forms={},
    sizes=((0.2, 0.6), (0.25, 0.6), (0.12, 0.4)),
    make=make(density={"wood_board": 500.0}),
    makes={},
    feet=True,
    trade="furniture",
    synset=None,
    wikidata="Q14745",
    partnet=None,
    body="card_index_body",
    places=(Place(role="crate", low=(0.3, 0.25, 0.15), high=(0.5, 0.5, 0.35), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=None,
    draw=draw,
)
'''


@pytest.fixture
def card_index(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The kind, in a file of its own."""
    folder = tmp_path / "kinds"
    folder.mkdir()
    (folder / "card_index.py").write_text(SOURCE)
    monkeypatch.setattr(artigen.kinds, "__path__", [*artigen.kinds.__path__, str(folder)])
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
