"""What is asked for becomes one request of the sketch, or a sentence that says why not."""

import pytest

from artigen.errors import ArtigenError
from artigen.shapes.draw import Wish
from artigen.sketch.request import SketchRequest, encode_request
from artigen.sketch.understand import Request, understand


def test_words_ask_for_the_same_as_flags():
    words = understand(Request(text="a table with three drawers, 1.4 m wide"))
    flags = understand(Request(category="Table", wish=Wish(width=1.4, counts=(("drawer", 3),))))
    assert words.request == flags.request
    assert words.request.width == pytest.approx(1.4)
    assert words.request.depth is None


def test_what_is_not_said_stays_open():
    request = understand(Request(category="Oven")).request
    assert request == SketchRequest(category="Oven")
    known = encode_request(request).known
    assert known[0, :2].all()
    assert not known[0, 2:].any()


def test_adjectives_stretch_only_what_is_open():
    assert understand(Request(text="a tall cabinet")).stretch == (("height", 1.35),)
    assert understand(Request(text="a tall cabinet, 2 m high")).stretch == ()


def test_parts_that_have_a_colour_are_there():
    request = understand(Request(text="a white fridge with black handles")).request
    assert request.some == ("handle",)


def test_the_colour_of_a_whole_table_is_that_of_its_top_and_legs():
    table = understand(Request(text="a blue table with a white shelf")).request.finishes
    colors = {finish.role: finish.color for finish in table}
    assert colors["body"] == colors["front"] == colors["leg"] != colors["top"]
    oven = understand(Request(text="a blue oven")).request.finishes
    assert {finish.role for finish in oven} == {"body", "front"}  # its top is a hob


def test_a_colour_of_a_part_goes_before_that_of_the_whole_and_some_name_a_material():
    finishes = {
        finish.role: finish
        for finish in understand(Request(text="an oak cabinet with two black handles")).request.finishes
    }
    assert finishes["body"].material == "wood"
    assert finishes["handle"].material is None
    assert max(finishes["handle"].color or (1.0,)) < 0.2
    doors = understand(Request(text="a white cabinet with two blue doors")).request.finishes
    front, body = ({finish.role: finish.color for finish in doors}[role] for role in ("front", "body"))
    assert front is not None
    assert body is not None
    assert front[2] > front[0] + 0.2
    assert min(body) > 0.8


def test_words_that_mean_nothing_are_named():
    assert "zebra" in understand(Request(text="a zebra cabinet")).notes[0]


def test_what_is_said_beyond_a_style_is_told_to_the_grammar():
    said = understand(Request(text="a fridge with a bottom freezer, hinged on the left"))
    assert set(said.features) == {("freezer", "at", "bottom"), ("door", "hinged", "left")}
    assert understand(Request(text="a cabinet with glass doors")).request.style == "framed_glass"
    knobs = understand(Request(text="a dresser with six brass knobs"))
    assert (knobs.request.counts, knobs.features) == ((("handle", 6),), (("handle", "type", "knob"),))


def test_a_door_beside_a_category_is_a_part_of_it():
    request = understand(Request(category="Refrigerator", text="a white door")).request
    assert (request.category, request.counts) == ("Refrigerator", (("door", 1),))


def test_metals_of_knobs_are_requested_as_steel_of_their_colour():
    (brass,) = understand(Request(text="a dresser with brass knobs")).request.finishes
    assert (brass.role, brass.material) == ("handle", "steel")
    assert brass.color is not None
    assert brass.color[0] > brass.color[2] + 0.2


@pytest.mark.parametrize(
    ("request_", "said"),
    [
        (Request(), "no category"),
        (Request(category="Spaceship"), "Spaceship"),
        (Request(category="Oven", text="a table"), "both Oven and Table"),
        (
            Request(category="Table", text="a table with two drawers", wish=Wish(counts=(("drawer", 3),))),
            "both 3 and 2",
        ),
        (Request(category="Table", wish=Wish(width=-1.0)), "width -1 m"),
        (Request(category="Table", wish=Wish(counts=(("base", 2),))), "2 parts called base"),
        (Request(text="hello"), "names no kind"),
        (Request(category="Refrigerator", wish=Wish(width=0.05)), r"expected 0.35 to 1.9 m"),
    ],
)
def test_contradictions_and_nonsense_are_refused(request_: Request, said: str):
    with pytest.raises(ArtigenError, match=said):
        understand(request_)


def test_a_kind_that_only_the_grammar_draws_is_refused_with_the_command_that_draws_it():
    learned = ("Table", "Safe")
    with pytest.raises(ArtigenError, match=r"'Laptop'.*Table, Safe.*`artigen shape Laptop` draws it"):
        understand(Request(category="Laptop"), learned)
    with pytest.raises(ArtigenError, match=r"that the model draws, one of Table, Safe$"):
        understand(Request(category="Spaceship"), learned)
    with pytest.raises(ArtigenError, match=r"no sketch network"):
        understand(Request(category="Safe"), ())
    assert understand(Request(category="Safe"), learned).request.category == "Safe"
