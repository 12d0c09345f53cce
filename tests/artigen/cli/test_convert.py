"""The choice between several sets of hulls for an object that keeps its own meshes."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import pytest

from artigen.api import convert, mend
from sim_export import attempts as attempts_module
from sim_export import export
from sim_export.attempts import HullWay, Judgement, change_hulls
from sim_export.errors import DegeneratePart
from sim_export.export import Exported

USUAL = HullWay()
VOXELS = HullWay(collision="voxels")


@dataclass(frozen=True)
class Numbered:
    """Stands for a package."""

    number: int
    records: tuple[str, ...] = ()
    painted: bool = False


def judge(failed=(), links=("link_0",), around=(), unlike=0.5):
    """A judgement."""
    links = frozenset(links)
    return Judgement(failed=tuple(failed), links=links, around=links | frozenset(around), unlike=unlike)


@pytest.fixture
def attempts(monkeypatch):
    """Plays exports that are judged in these ways, or cannot be made (None); returns what was asked for."""

    def play(judged):
        asked = []

        def export_solids(solids, way, *, source_meshes, provenance):
            asked.append(way)
            if judged[len(asked) - 1] is None:
                raise DegeneratePart(f"attempt {len(asked)} is flat")
            package = Numbered(number=len(asked) - 1)
            return Exported(package=package, seconds=(("clearance", 1.0), ("attach", 2.0)))

        monkeypatch.setattr(
            export, "make_solids", lambda asset, surfaces: SimpleNamespace(seconds=(), asset=None)
        )
        monkeypatch.setattr(export, "export_solids", export_solids)
        monkeypatch.setattr(export, "judge_package", lambda package: judged[package.number])
        monkeypatch.setattr(
            export, "paint_package", lambda package, asset, unpainted: replace(package, painted=True)
        )
        for name in ("place_source_meshes", "place_source_surfaces"):
            monkeypatch.setattr(mend, name, lambda source, asset: ())
        return asked

    return play


def ways(*judged, first=USUAL):
    """The ways in which hulls are made after these judgements, until nothing is to be gained."""
    out, way = [], first
    for one in judged:
        out.append(way)
        way = change_hulls(way, one)
        if way is None:
            return out
    return [*out, way]


def test_links_that_fail_get_smaller_hulls_then_their_neighbours_then_leaves_are_spared_then_divided_ones():
    likeness = judge(["V103"], ["link_1"], ["body"])
    both = frozenset({"link_1", "body"})
    assert ways(*6 * [likeness]) == [
        HullWay(),
        HullWay(finer=frozenset({"link_1"})),
        HullWay(finer=both),
        HullWay(finer=both, shares=True),
        HullWay(finer=both, divided=True),
        HullWay(finer=both, divided=True, shares=True),
        VOXELS,
    ]


def test_hulls_of_voxels_are_made_again_in_the_same_ways():
    first, likeness = HullWay(collision="voxels"), judge(["V103"], ["link_1"], ["body"])
    tried = ways(*6 * [likeness], first=first)
    assert [way.collision for way in tried] == 6 * ["voxels"]
    assert [len(way.finer) for way in tried] == [0, 1, 2, 2, 2, 2]
    assert [way.shares for way in tried] == [False, False, False, True, False, True]
    assert [way.divided for way in tried] == [False, False, False, False, True, True]


def test_links_that_meet_on_their_way_only_are_cut_otherwise_before_they_get_smaller_hulls():
    meet = judge(["V201"], ["link_0", "link_1"])
    both = frozenset({"link_0", "link_1"})
    assert ways(*5 * [meet]) == [
        HullWay(),
        HullWay(shares=True),
        HullWay(shares=True, finer=both),
        HullWay(divided=True, finer=both),
        HullWay(divided=True, finer=both, shares=True),
        VOXELS,
    ]


def test_an_object_with_too_many_hulls_gets_fewer_once_before_its_other_faults_are_dealt_with():
    many, likeness = judge(["V006"], ["link_1"]), judge(["V103"], ["link_1"])
    finer = frozenset({"link_1"})
    assert ways(many, many, likeness)[:3] == [HullWay(), HullWay(fewer=True), HullWay(finer=finer)]
    assert ways(likeness, many) == [HullWay(), HullWay(finer=finer), HullWay(finer=finer, fewer=True)]


def test_nothing_is_tried_after_the_last_hulls_of_voxels_or_after_a_package_that_passes():
    last = replace(VOXELS, finer=frozenset({"link_0"}), divided=True, shares=True)
    assert change_hulls(last, judge(["V103"])) is None
    assert change_hulls(VOXELS, None) is None
    assert change_hulls(HullWay(), judge()) is None


@pytest.mark.parametrize(
    ("failed", "unlike", "chosen", "tried"),
    [
        ((0,), (0.9,), 0, 1),
        ((2, 0), (0.9, 0.9), 1, 2),
        ((2, 1, 0), (0.9, 0.5, 0.7), 2, 3),
        ((1, 2, 2, 0), (0.9, 0.5, 0.7, 0.8), 3, 4),
        ((1, *9 * (2,)), (0.9, *9 * (0.6,)), 0, 10),
        (10 * (1,), (0.9, 0.5, *8 * (0.6,)), 1, 10),
        ((*9 * (1,), 0), 10 * (0.6,), 9, 10),
    ],
)
def test_hulls_are_made_again_while_they_fail_and_the_best_are_kept(attempts, failed, unlike, chosen, tried):
    judged = [
        judge(["V103", "V105"][:count], unlike=value) for count, value in zip(failed, unlike, strict=True)
    ]
    asked = attempts(judged)
    seen = []
    made = convert.export_source(None, None, {}, lambda package: seen.append(package) or package)
    assert made.package == Numbered(number=chosen, painted=True)
    assert len(asked) == tried
    assert [package.painted for package in seen] == [False] * tried + [True]
    seconds = dict(made.seconds)
    assert seconds.pop("texture") >= 0.0
    assert seconds == {"clearance": tried, "attach": 2.0 * tried}


def test_what_needs_no_paint_is_finished_once_for_each_attempt(attempts, monkeypatch):
    attempts((judge(["V103"]), judge()))
    monkeypatch.setattr(export, "paint_package", lambda package, asset, unpainted: package)
    seen = []
    made = convert.export_source(None, None, {}, lambda package: seen.append(package) or package)
    assert [package.number for package in seen] == [0, 1]
    assert made.package == seen[1]


def test_an_attempt_that_cannot_be_made_is_recorded_and_voxels_are_tried(attempts):
    asked = attempts((None, judge()))
    made = convert.export_source(None, None, {})
    assert asked == [HullWay(), VOXELS]
    assert made.package.number == 1
    assert [record.split(": ")[1] for record in made.package.records] == ["attempt 1 is flat"]


def test_if_no_attempt_can_be_made_the_first_error_is_told(attempts):
    attempts((None, None))
    with pytest.raises(DegeneratePart, match="attempt 1"):
        convert.export_source(None, None, {})


def test_a_judgement_names_the_links_that_fail_and_those_that_a_joint_connects_to_them(monkeypatch):
    def joined(child, parent):
        return SimpleNamespace(child=child, parent=parent)

    def named(*failing):
        checks = [SimpleNamespace(id="V103", verdict="fail", links=failing, value=2.0)]
        monkeypatch.setattr(attempts_module, "run_checks", lambda subject, only: checks)
        return attempts_module.judge_package(package).around

    links = ("door", "lid", "lid_carrier", "knob", "body")
    package = SimpleNamespace(
        links=[SimpleNamespace(name=name, parts=() if "carrier" in name else (name,)) for name in links],
        joints=[
            joined("door", "body"),
            joined("knob", "door"),
            joined("lid", "lid_carrier"),
            joined("lid_carrier", "body"),
        ],
    )
    monkeypatch.setattr(attempts_module, "read_draft", lambda package: None)
    assert named("knob") == {"knob", "door"}
    assert named("knob", "lid") == {"knob", "door", "lid", "body"}
    assert named("body", "door") == {"body", "door", "lid", "knob"}
    assert named() == {"door", "lid", "knob", "body"}
    assert attempts_module.judge_package(package).links == {"door", "lid", "knob", "body"}
