"""Usual numbers of fronts: counted where everything is marked, and only for kinds that have few."""

from pathlib import Path

import numpy as np

from artigen.examples.front_counts import ENOUGH, FEW, count_photos, share_counts, share_left_hinges
from artigen.examples.marked_photos import MarkedPhoto
from artigen.examples.reader_views import BODY, NOTHING, PART, View
from artigen.examples.view_shards import pack_views
from artigen.reader.labels import FRONT, KINDS


def view_of(kind: str, doors: int, drawers: int) -> View:
    """Fronts side by side, each of 4 x 16 pixels, and one that is too small to count."""
    count = doors + drawers
    ids = np.full((32, 4 * count + 8), NOTHING, np.uint16)
    ids[4:20, 2:-2] = 0
    for k in range(count):
        ids[4:20, 4 + 4 * k : 8 + 4 * k] = k + 1
    parts = np.zeros(count + 2, PART)
    parts["thing"] = [-1] + [FRONT] * (count + 1)
    parts["door"] = [-1] + [1] * doors + [0] * drawers + [1]
    bodies = np.zeros(1, BODY)
    bodies["kind"] = KINDS.index(kind)
    return View(rgba=np.zeros((*ids.shape, 4), np.uint8), ids=ids, parts=parts, bodies=bodies)


def photo(fronts: list[str], *, complete: bool = True, kind: str = "refrigerator") -> MarkedPhoto:
    marked = tuple(
        {"label": label, "box": [0.1, 0.1 + 0.1 * k, 0.5, 0.2 + 0.1 * k], "kind": kind}
        for k, label in enumerate(fronts)
    )
    none = np.zeros((0, 4), np.float32)
    return MarkedPhoto(
        path=Path("none.jpg"), fronts=marked, pulls=none, room_doors=none, complete=complete,
        objects=(("Refrigerator", np.array([0.1, 0.1, 0.5, 0.9], np.float32), True),),
    )  # fmt: skip


def shard(folder: Path, views: list[View]) -> list[Path]:
    np.savez(folder / "shard_00000.npz", **pack_views(views))
    return [folder / "shard_00000.npz"]


def test_shares_are_those_of_what_is_in_view(tmp_path: Path):
    views = [view_of("Refrigerator", 2, 0)] * 3 + [view_of("Refrigerator", 1, 1)]
    assert share_counts(shard(tmp_path, views), []) == {"Refrigerator": {(2, 0): 0.75, (1, 1): 0.25}}


def test_kinds_with_any_number_of_fronts_have_no_usual_one(tmp_path: Path):
    few, many = view_of("Dresser", 0, FEW), view_of("Dresser", 0, FEW + 1)
    assert "Dresser" in share_counts(shard(tmp_path, [few] * 9 + [many]), [])
    assert "Dresser" not in share_counts(shard(tmp_path, [few] * 8 + [many] * 2), [])


def test_photographs_weigh_as_much_as_views_from_enough_on(tmp_path: Path):
    shards = shard(tmp_path, [view_of("Refrigerator", 2, 0)])
    some = [photo(["door"])] * (ENOUGH - 1)
    assert share_counts(shards, some)["Refrigerator"] == {(2, 0): 1.0}
    assert share_counts(shards, [*some, photo(["door"])])["Refrigerator"] == {(2, 0): 0.5, (1, 0): 0.5}


def test_only_appliances_that_are_marked_completely_count():
    assert count_photos([photo(["door", "drawer"])])["Refrigerator"] == {(1, 1): 1}
    for other in (photo(["door"], complete=False), photo(["door", "pair"]), photo(["door"], kind="oven")):
        assert not count_photos([other])


def test_hinges_count_where_no_front_is_beside():
    def door(x: float, y: float, side: str) -> dict:
        return {
            "label": "door", "box": [x, y, x + 0.2, y + 0.3], "kind": "refrigerator", "hinge": side,
        }  # fmt: skip

    none = np.zeros((0, 4), np.float32)

    def photo_of(*fronts: dict) -> MarkedPhoto:
        return MarkedPhoto(path=Path("none.jpg"), fronts=fronts, pulls=none, room_doors=none, complete=True)

    stacked = photo_of(door(0.1, 0.1, "right"), door(0.1, 0.41, "right"))
    beside = photo_of(door(0.1, 0.1, "left"), door(0.31, 0.1, "right"))
    half = ENOUGH // 2
    shares = share_left_hinges([stacked] * half + [beside] * 9)
    assert shares == {"Refrigerator": round(1 / (2 * half + 2), 3)}
    assert share_left_hinges([stacked] * (half - 1) + [beside] * 9) == {}
