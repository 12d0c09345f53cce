"""The choice between several sets of hulls for an object that keeps its own meshes."""

import pytest

from artigen.cli import convert, source_meshes
from sim_export import export
from sim_export.collision.surface_hulls import FINER, SPARING, USUAL
from sim_export.export import Exported


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
def test_hulls_are_made_again_while_they_fail_and_the_best_are_kept(monkeypatch, failed, chosen, tried):
    likeness = (0.9, 0.5, 0.7, 0.8)  # decides between as many failures
    asked = []

    def export_asset(asset, *, source_meshes, surfaces, detail, provenance):
        asked.append(None if surfaces is None else detail)
        return Exported(package=len(asked) - 1, seconds=(("mesh", 1.0), ("mass", 2.0)))

    monkeypatch.setattr(export, "export_asset", export_asset)
    monkeypatch.setattr(convert, "judge_package", lambda number: (failed[number], likeness[number]))
    for name in ("place_source_meshes", "place_source_surfaces"):
        monkeypatch.setattr(source_meshes, name, lambda source, asset: ())
    made = convert.export_source(None, None, {})
    assert made.package == chosen
    assert asked == [USUAL, FINER, SPARING, None][:tried]
    assert dict(made.seconds) == {"mesh": tried, "mass": 2.0 * tried}
