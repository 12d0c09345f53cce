"""The search for hulls: what follows a judgement, and that the best package so far is the result."""

from types import SimpleNamespace
from typing import Any

import pytest
from curved_shells import OBJECTS
from form import write_form
from unseen_forms import DEVELOPED, HELD_OUT

import artigen
from artigen.runtime.budget import Budget
from sim_export import search as search_module
from sim_export.checks.draft import read_draft
from sim_export.checks.suite import run_checks
from sim_export.errors import DegeneratePart
from sim_export.search import COLLISION_CHECKS, HullPlan, Judgement, refine_plan, search_hulls

pytestmark = pytest.mark.slow

USUAL, VOXELS = HullPlan(), HullPlan(target="voxels")


def judge(*failed: str, links=("link_0",), around=(), unlike=0.5) -> Judgement:
    """A judgement."""
    links = frozenset(links)
    return Judgement(failed=failed, links=links, around=links | frozenset(around), unlike=unlike)


def finer(**levels: int) -> HullPlan:
    """The usual plan with other levels for some links."""
    return HullPlan(levels=frozenset(levels.items()))


def search(*judged: Judgement | None, seconds: float = 100.0):
    """Plays objects that take a second each and are judged in these ways, or cannot be made (None)."""
    plans, time = [], [0.0]

    def make(plan: HullPlan) -> int:
        plans.append(plan)
        time[0] += 1.0
        if judged[min(len(plans), len(judged)) - 1] is None:
            raise DegeneratePart(f"plan {len(plans)} is flat")
        return len(plans) - 1

    budget = Budget(seconds, lambda: time[0])
    found = search_hulls(USUAL, make, lambda made: judged[min(made, len(judged) - 1)] or judge(), budget)
    return found, plans, budget


def test_links_that_fail_get_smaller_hulls_beside_voxels_then_their_neighbours_do():
    following = list(refine_plan(USUAL, judge("V103", links=["door"], around=["body"])))
    assert following == [finer(door=1), VOXELS, finer(door=1, body=1), HullPlan(shares=True)]
    assert next(refine_plan(finer(door=1), judge("V103", links=["door"]))) == finer(door=2)


def test_links_that_only_meet_are_cut_otherwise_before_they_get_smaller_hulls():
    following = list(refine_plan(USUAL, judge("V201", links=["door", "body"])))
    assert following[:2] == [HullPlan(shares=True), finer(door=1, body=1)]


def test_too_many_hulls_become_fewer_before_anything_else():
    few = next(refine_plan(finer(door=1), judge("V006", "V103", links=["door"])))
    assert few == HullPlan(levels=finer(door=1).levels, fewer=True)
    assert not any(plan.fewer for plan in refine_plan(few, judge("V006", "V103")))


def test_the_result_is_the_best_of_all_and_the_first_that_passes_is_the_last():
    first, second, third = judge("V103", "V105"), judge("V103", unlike=1.1), judge("V103", unlike=1.2)
    found, plans, budget = search(first, second, third, judge())
    assert (found.best, len(plans), budget.cut_short) == (3, 4, False)
    found, _, budget = search(first, second, third, seconds=2.5)
    assert (found.best, found.made, budget.cut_short) == (1, 3, True)


def test_one_object_is_made_however_little_time_there_is():
    found, plans, _ = search(judge("V103"), seconds=0.0)
    assert (found.best, plans) == (0, [USUAL])


def test_a_search_ends_where_nothing_changes_any_more():
    _, plans, budget = search(judge("V103", unlike=1.2))
    assert len(plans) == len(set(plans)) <= 8
    assert not budget.cut_short


def test_plans_that_cannot_be_carried_out_are_told_and_the_first_error_is_raised_where_all_are():
    found, plans, _ = search(None, judge())
    assert (plans, found.best, [str(error) for error in found.errors]) == (
        [USUAL, VOXELS],
        1,
        ["plan 1 is flat"],
    )
    with pytest.raises(DegeneratePart, match="plan 1"):
        search(None)


def test_a_judgement_names_the_links_that_fail_and_those_that_a_joint_connects_to_them(monkeypatch):
    def joined(child, parent):
        return SimpleNamespace(child=child, parent=parent)

    def named(*failing):
        checks = [SimpleNamespace(id="V103", verdict="fail", links=failing, value=2.0)]
        monkeypatch.setattr(search_module, "run_checks", lambda subject, only: checks)
        return search_module.judge_package(package).around

    links = ("door", "lid", "lid_carrier", "knob", "body")
    package: Any = SimpleNamespace(
        links=[SimpleNamespace(name=name, parts=() if "carrier" in name else (name,)) for name in links],
        joints=[
            joined("door", "body"),
            joined("knob", "door"),
            joined("lid", "lid_carrier"),
            joined("lid_carrier", "body"),
        ],
    )
    monkeypatch.setattr(search_module, "read_draft", lambda package, known: None)
    assert named("knob") == {"knob", "door"}
    assert named("knob", "lid") == {"knob", "door", "lid", "body"}
    assert named("body", "door") == {"body", "door", "lid", "knob"}
    assert named() == {"door", "lid", "knob", "body"}
    assert search_module.judge_package(package).links == {"door", "lid", "knob", "body"}


def test_time_that_ends_leaves_a_package_and_says_so(tmp_path):
    source = write_form(OBJECTS["bread_bin"](), tmp_path, "bread_bin")
    package = artigen.convert(source, budget=0.0).package
    assert all(link.hulls for link in package.links)
    assert any("budget of 0 s ended the search" in record for record in package.records)


def test_a_budget_that_suffices_changes_nothing(tmp_path):
    """A door whose first hulls fail."""
    make, flaws, reach = HELD_OUT["door"]
    source = write_form(make(), tmp_path, "door", flaws, reach)
    first, second = (artigen.convert(source, budget=seconds).package for seconds in (1e3, 1e6))
    assert first.records == second.records
    assert not any("budget" in record for record in first.records)
    for one, other in zip(first.links, second.links, strict=True):
        assert [hull.vertices.tobytes() for hull in one.hulls] == [
            hull.vertices.tobytes() for hull in other.hulls
        ]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bread_bin", "stapler", "pen"])
def test_curved_shells_pass_within_the_budget(name, tmp_path):
    """V103 holds their hulls to 3 % of the diagonal, 99 % of the surface to 1.5 %, and cavities to 90 %."""
    make, flaws, reach = DEVELOPED.get(name) or (OBJECTS[name], (), 1.0)
    source = write_form(make(), tmp_path, name, flaws, reach)
    shells = artigen.convert(source, mend=True)  # holds the folder of its meshes
    checks = run_checks(read_draft(shells.package), only=COLLISION_CHECKS)
    assert [check for check in checks if check.verdict == "fail"] == []
