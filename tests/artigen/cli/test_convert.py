"""The choice between several sets of hulls for an object that keeps its own meshes."""

from dataclasses import dataclass

import pytest

from artigen.cli import convert, mend
from sim_export import export
from sim_export.collision.surface_hulls import FINER, SPARING, USUAL
from sim_export.errors import DegeneratePart
from sim_export.export import Exported

ATTEMPTS = [USUAL, FINER, SPARING, None]


@dataclass(frozen=True)
class Numbered:
    """Stands for a package."""

    number: int
    records: tuple[str, ...] = ()


@pytest.fixture
def attempts(monkeypatch):
    """Plays exports that fail so many checks, or cannot be made (None); returns what was asked for."""

    def play(failed):
        likeness = (0.9, 0.5, 0.7, 0.8)  # decides between as many failures
        asked = []

        def export_asset(asset, *, source_meshes, surfaces, detail, covers, provenance):
            assert len(covers) == len(asked)  # what earlier attempts made is there
            covers[len(asked)] = ()
            asked.append(None if surfaces is None else detail)
            if failed[len(asked) - 1] is None:
                raise DegeneratePart(f"attempt {len(asked)} is flat")
            package = Numbered(number=len(asked) - 1)
            return Exported(package=package, seconds=(("mesh", 1.0), ("mass", 2.0)))

        monkeypatch.setattr(export, "export_asset", export_asset)
        monkeypatch.setattr(
            convert, "judge_package", lambda package: (failed[package.number], likeness[package.number])
        )
        for name in ("place_source_meshes", "place_source_surfaces"):
            monkeypatch.setattr(mend, name, lambda source, asset: ())
        return asked

    return play


@pytest.mark.parametrize(
    ("failed", "chosen", "tried"),
    [
        ((0,), 0, 1),
        ((2, 0), 1, 2),
        ((2, 1, 0), 2, 3),
        ((1, 2, 2, 0), 3, 4),
        ((1, 2, 2, 2), 0, 4),
        ((1, 1, 1, 1), 1, 4),
    ],
)
def test_hulls_are_made_again_while_they_fail_and_the_best_are_kept(attempts, failed, chosen, tried):
    asked = attempts(failed)
    made = convert.export_source(None, None, {})
    assert made.package == Numbered(number=chosen)
    assert asked == ATTEMPTS[:tried]
    assert dict(made.seconds) == {"mesh": tried, "mass": 2.0 * tried}


def test_an_attempt_that_cannot_be_made_is_recorded_and_the_next_is_tried(attempts):
    attempts((None, 1, None, 2))
    made = convert.export_source(None, None, {})
    assert made.package.number == 1
    assert [record.split(": ")[1] for record in made.package.records] == [
        "attempt 1 is flat",
        "attempt 3 is flat",
    ]


def test_if_no_attempt_can_be_made_the_first_error_is_told(attempts):
    attempts((None, None, None, None))
    with pytest.raises(DegeneratePart, match="attempt 1"):
        convert.export_source(None, None, {})
