"""Wall cabinets above the low stretches of runs."""

import numpy as np

from .arrange import Place, Plan, Taste, best_place, wall_places
from .choose import TALL, Offer, Wall, choose_units
from .footprints import is_level
from .pieces import line_up
from .recipes import Share
from .room import Side, wall_axis
from .runs import Chooser, count_objects, member_boxes, runs_of

HUNG_HEIGHT = 1.45
"""Height (m) of the undersides of wall cabinets above the floor."""


def hang_cabinets(plan: Plan, share: Share, chooser: Chooser) -> Plan:
    """The plan with wall cabinets above low stretches of its runs, except above the stove."""
    entries = [entry for entry in chooser.shortlists[share.role.name] if is_level(entry.folder, "bottom")]
    stretches: list[tuple[Side, float, tuple[float, float]]] = [
        (side, run.cluster.depth, stretch)
        for side, run in runs_of(plan).items()
        for stretch in _low_stretches(side, run)
    ]
    if not entries or not stretches:
        return plan
    walls = [Wall(length=stop - start) for _, _, (start, stop) in stretches]
    offers = [Offer(share=0, entry=entry) for entry in entries]
    room_left = max(0, min(share.most, chooser.most - count_objects(plan)))
    asked = Share(role=share.role, wanted=min(share.wanted, room_left), most=room_left)
    chosen = choose_units(offers, [asked], walls, chooser.rng) or []
    for (side, depth, (start, stop)), units in zip(stretches, chosen, strict=False):
        while units:
            pieces = []
            for unit in units:
                front = unit.entry.size[0] / 2.0 - depth
                pieces.append(chooser.piece(unit.entry, share.role.name, front, HUNG_HEIGHT))
            cluster = line_up("hung", pieces, HUNG_HEIGHT)
            middle = (start + stop - cluster.length) / 2.0
            starts = np.array([middle, start, stop - cluster.length])
            places = wall_places(plan, cluster, side, starts[starts >= start - 0.01])
            taste = Taste(entrance=0.0, noise=0.0)
            place = best_place(plan, places, taste, chooser.rng)
            if place is not None:
                plan = plan.with_place(place)
                break
            units = units[:-1]
    return plan


def _low_stretches(side: Side, run: Place) -> list[tuple[float, float]]:
    """Intervals along the wall over which every unit is low and none is a stove."""
    axis = wall_axis(side)
    spans = sorted(
        (float(box[0, axis]), float(box[1, axis]), member.piece.role != "range" and box[1, 2] <= TALL)
        for box, member in zip(member_boxes(run), run.cluster.members, strict=True)
    )
    stretches: list[tuple[float, float]] = []
    for start, stop, low in spans:
        if not low:
            continue
        if stretches and start - stretches[-1][1] < 0.1:
            stretches[-1] = (stretches[-1][0], stop)
        else:
            stretches.append((start, stop))
    return [stretch for stretch in stretches if stretch[1] - stretch[0] > 0.3]
