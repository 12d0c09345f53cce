"""Words, numbers and a photograph are one condition: what people say overrules pixels, the rest stays."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from artigen.api.models import load_sketch
from artigen.errors import ArtigenError
from artigen.reader.layout.frontal import read_shape
from artigen.reader.reading import Reading
from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.sheet import draw_picture
from artigen.sketch import model
from artigen.sketch.asked import HELD, POLISHED, Asked, ask, draw_asked, merge_reading
from artigen.sketch.model import Drawn, SketchConfig
from artigen.sketch.network import SketchNetwork
from artigen.sketch.request import SketchRequest
from artigen.sketch.told import GLOSS
from artigen.sketch.understand import Request, understand
from artigen.weights import SHIPPED

READ = read_shape(draw_shape("StorageFurniture", 3), view=(0.2, 0.2, 0.2))
"""A cabinet as it is read at a slant."""


def refuse() -> SketchNetwork:
    raise AssertionError("a photograph needs no sketch network")


def merge(text: str | None = None, category: str | None = None, **wish: object) -> Asked:
    request = Request(category=category, text=text, image=Path("photo.jpg"), wish=Wish(**wish))  # type: ignore[arg-type]
    return merge_reading(understand(request), READ)


def build(asked: Asked) -> Reading:
    return read_shape(draw_asked(asked, 5, refuse).shape)


def describe(reading: Reading) -> list[tuple[str, str | None]]:
    return [(part.label, part.hinge) for part in reading.fronts]


def test_a_photograph_alone_is_built_as_it_was_read():
    built = build(merge())
    assert built.counts["door"] == READ.counts["door"]
    assert built.counts["drawer"] == READ.counts["drawer"]
    assert built.kind == READ.kind


def test_only_what_is_said_changes():
    plain, wide = build(merge()), build(merge(width=1.3))
    assert wide.size[0] == pytest.approx(1.3, abs=1e-6)
    assert wide.size[2] / plain.size[2] == pytest.approx(wide.size[0] / plain.size[0], rel=1e-6)
    assert describe(wide) == describe(plain)
    both = build(merge("30 cm deep", height=0.8))
    assert both.size[1:] == pytest.approx((0.3, 0.8), abs=0.05)
    assert describe(both) == describe(plain)


def test_words_and_numbers_say_the_same():
    said, given = merge("with two doors and four drawers"), merge(counts=(("door", 2), ("drawer", 4)))
    assert said.request.counts == given.request.counts
    assert said.reading is not None
    assert given.reading is not None
    assert said.reading.to_json() == given.reading.to_json()
    assert build(said).counts["drawer"] == 4


def test_words_overrule_hinges_kind_handles_stand_and_colours():
    asked = merge(
        "a red wardrobe on wheels with knob handles, hinged on the left", counts=(("door", 3), ("drawer", 0))
    )
    shape = draw_asked(asked, 2, refuse).shape
    built = read_shape(shape)
    assert shape.category == "Wardrobe"
    assert describe(built) == [("door", "left")] * 3
    assert built.counts["handle"] == READ.counts["handle"] or built.counts["handle"] >= 1
    assert dict(shape.condition.counts)["wheel"] == 4
    red, green, blue = dict(shape.finishes)["front"].color
    assert red > 2 * max(green, blue)
    assert {part.form for part in built.parts if part.label == "handle"} <= {"knob"}


def test_a_tall_one_is_taller_than_what_was_read():
    plain, tall = build(merge()), build(merge("a tall one"))
    assert tall.size[2] == pytest.approx(1.35 * plain.size[2], rel=0.02)
    assert tall.size[0] == pytest.approx(plain.size[0], rel=0.02)


def test_what_cannot_be_met_is_refused_or_said():
    with pytest.raises(ArtigenError, match="style 'steel'"):
        merge(style="steel")
    with pytest.raises(ArtigenError, match="number of doors"):
        merge("with two doors", counts=(("door", 3),))
    assert any("shelf=4" in note for note in merge(counts=(("shelf", 4),)).notes)


def test_a_photograph_is_read_once_until_it_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    read: list[object] = []

    def count(_: Path, *, box: object) -> Reading:
        read.append(box)
        return READ

    monkeypatch.setattr("artigen.sketch.asked.read_photo", count)
    photo = tmp_path / "photo.png"
    Image.new("RGB", (20, 20)).save(photo)
    for seed in range(3):
        ask(Request(image=photo), refuse, seed)
    assert len(read) == 1
    ask(Request(image=photo, box=(0, 0, 0.5, 1)), refuse)
    Image.new("RGB", (21, 20)).save(photo)
    ask(Request(image=photo), refuse)
    assert len(read) == 3


@pytest.mark.slow
def test_a_photograph_is_drawn_without_the_sketch_network(tmp_path: Path):
    shape = draw_shape("Refrigerator", 2)
    Image.fromarray(draw_picture(shape, np.zeros(len(shape.parts)), 256)).save(tmp_path / "fridge.png")
    asked = ask(Request(image=tmp_path / "fridge.png", category="Refrigerator"), refuse)
    drawn = draw_asked(asked, 0, refuse)
    assert drawn.shape.category == "Refrigerator"
    assert asked.reading is not None
    held = read_shape(drawn.shape).counts
    assert all(held[label] == asked.reading.counts[label] for label in ("door", "drawer"))
    assert any("was read as" in note for note in asked.notes)
    left = ask(
        Request(image=tmp_path / "fridge.png", box=(0.0, 0.0, 0.5, 1.0), category="Refrigerator"), refuse
    )
    assert left.reading is not None
    assert left.reading.box[2] <= 0.56
    assert replace(asked, notes=()).request == asked.request


@pytest.fixture(scope="module")
def shipped() -> SketchNetwork:
    return load_sketch(SHIPPED)


@pytest.mark.parametrize("litres", [30, 45])
def test_a_volume_scales_the_extents_that_are_not_given(litres: int, shipped: SketchNetwork):
    request = ask(Request(text=f"a pedal bin of {litres} litres, 30 cm wide"), lambda: shipped, 1).request
    assert request.width == pytest.approx(0.3)
    sizes = (request.width, request.depth, request.height)
    assert HELD * float(np.prod(np.array(sizes))) == pytest.approx(litres / 1000, rel=1e-6)


def test_a_volume_that_no_object_of_the_kind_has_is_refused(shipped: SketchNetwork):
    with pytest.raises(ArtigenError, match=r"^2000 litres: .* expected"):
        ask(Request(text="a bin of 2000 litres"), lambda: shipped, 1)


def test_a_surface_changes_the_gloss_of_paint_and_wood_alone():
    plain, matte = (draw_asked(merge(text), 5, refuse).shape for text in (None, "matte"))
    for (role, before), (_, after) in zip(plain.finishes, matte.finishes, strict=True):
        assert after == (replace(before, gloss=GLOSS["matte"]) if before.kind in POLISHED else before), role


@pytest.mark.parametrize(("picture", "batches"), [(None, 24), (np.zeros((4, 8, 8)), 48)])
def test_pictures_have_twice_as_many_batches_as_words(
    picture: np.ndarray | None, batches: int, monkeypatch: pytest.MonkeyPatch
):
    """24: the grammar, which draws after those, cannot draw by pictures."""
    tried: list[int] = []

    def draw(*args: object) -> Drawn:
        tried.append(next(one for one in args if isinstance(one, SketchConfig)).batches)
        return Drawn(shape=draw_shape("Oven", 0), faults=(), notes=())

    for name in ("draw_object", "draw_pictured"):
        monkeypatch.setattr(model, name, draw)
    draw_asked(Asked(request=SketchRequest(category="Oven"), picture=picture), 0, lambda: None)  # type: ignore[arg-type]
    assert tried == [batches]


def test_ranges_and_proportions_beside_a_photograph_are_said_not_to_be_met():
    notes = " ".join(merge("at most 1 m wide, as deep as high, 80 litres").notes)
    assert all(
        f"{what} are not asked for beside a photograph" in notes
        for what in ("litres", "ranges", "proportions")
    )


def test_a_volume_leaves_what_has_a_range_within_it(shipped: SketchNetwork):
    request = Request(text="a 60-litre trash can, at most 30 cm wide")
    found = ask(request, lambda: shipped, 0).request
    assert found.width is not None
    assert found.width <= 0.3
    assert HELD * found.width * (found.depth or 0) * (found.height or 0) == pytest.approx(0.06)
