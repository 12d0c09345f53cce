"""Runs of cabinets keep corners free, and their gaps are closed."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from envs.rooms.arrange import Plan, wall_places
from envs.rooms.catalogue import Catalogue, Entry
from envs.rooms.choose import Offer
from envs.rooms.pieces import Boxes, Cluster, Member, Piece, join_boxes, move_boxes
from envs.rooms.recipes import KITCHEN
from envs.rooms.room import Opening
from envs.rooms.runs import _place_run, close_gaps, draw_shortlists

PLAN = Plan(size=(4.0, 3.5, 2.6), entrance=Opening(side="front", start=1.5, width=0.9, height=2.0))
NONE = np.zeros((0, 2, 3))
UNIT = Piece(
    role="base cabinet",
    entry=None,
    boxes=Boxes(bodies=np.array([[[-0.6, 0.0, 0.0], [0.0, 0.8, 0.9]]]), sweeps=NONE, stands=NONE),
    face=-0.58,
)


@pytest.mark.parametrize(("gap", "closed"), [(0.0119, 0), (0.0121, 1)])
def test_a_gap_of_more_than_twelve_millimetres_gets_a_panel(gap: float, closed: int):
    beside = np.eye(4)
    beside[1, 3] = 0.8 + gap
    members = tuple(Member(piece=UNIT, T=T) for T in (np.eye(4), beside))
    boxes = join_boxes([move_boxes(member.piece.boxes, member.T) for member in members])
    run = Cluster(name="back", members=members, boxes=boxes, length=1.6 + gap, depth=0.6)
    place = next(wall_places(PLAN, run, "back", np.array([1.0])))
    assert len(close_gaps(PLAN.with_place(place)).places) == 1 + closed


@pytest.mark.parametrize("end", [0, 1])
def test_a_corner_takes_eighty_eight_centimetres_of_a_run(end: int):
    entry = Entry(
        folder=Path("x"), name="x", category="StorageFurniture", size=(0.6, 0.8, 0.9), kinds=(), provenance=()
    )
    share = next(index for index, one in enumerate(KITCHEN.shares) if one.role.name == "base cabinet")
    chooser: Any = SimpleNamespace(piece=lambda entry, name: replace(UNIT, entry=None, role=name))
    plan = _place_run(PLAN, KITCHEN, chooser, "back", [end], [Offer(share=share, entry=entry)])
    assert plan is not None
    (body,) = plan.boxes.bodies
    assert (body[0, 0] if end == 0 else 4.0 - body[1, 0]) == pytest.approx(0.88)


def test_alike_packages_are_of_one_suite_where_it_has_the_role():
    sizes = {"Refrigerator": (0.68, 0.7, 1.75), "Oven": (0.67, 0.6, 0.92), "Dishwasher": (0.64, 0.6, 0.86)}
    entries = [
        Entry(
            folder=Path(family), name=f"{category}_{family}", category=category, size=size, kinds=(),
            provenance=(("family", family), ("suite", "1")),
        )
        for category, size in sizes.items()
        for family in ("shaker", "slab", "rustic")
        if (category, family) != ("Dishwasher", "slab")
    ]  # fmt: skip
    catalogue = Catalogue(folder=Path(), entries=tuple(entries))
    seen = set()
    for seed in range(8):
        lists = draw_shortlists(KITCHEN, catalogue, np.random.default_rng(seed), 5, alike=True)
        looks = {role: {entry.suite for entry in found} for role, found in lists.items() if found}
        assert all(len(suites) == 1 for suites in looks.values())
        assert looks["fridge"] == looks["range"]
        seen |= looks["fridge"]
    assert len(seen) > 1
    mixed = draw_shortlists(KITCHEN, catalogue, np.random.default_rng(0), 5, alike=False)
    assert len({entry.suite for entry in mixed["fridge"]}) == 3
