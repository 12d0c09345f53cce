"""Extensions: what a distribution adds is found by its entry points, and what is wrong with one is said."""

from dataclasses import replace
from pathlib import Path

import pytest
from extension import install_extension

import artigen
from artigen.errors import ArtigenError
from artigen.kind import forget, kinds
from artigen.plugins import PluginError
from envs.config import EngineChoice
from envs.engines.choose import choose_engines
from envs.engines.witness import ask_engines, find_witnesses
from sim_export.checks.suite import CHECKS, find_checks, run_checks


@pytest.fixture
def install(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """Installs the example extension, with other entry points if some are given."""

    def run(changed: dict[str, dict[str, str]] | None = None) -> None:
        install_extension(monkeypatch, tmp_path, changed)
        forget()

    yield run
    monkeypatch.undo()
    forget()
    assert find_checks() == CHECKS


def test_a_distribution_adds_a_kind_a_check_an_engine_and_a_format(install, tmp_path: Path):
    install()
    drawn = artigen.sample("CardIndex", 3)
    exported = drawn.export(tmp_path / "index", formats=("package", "joints_csv"))
    name, kind, *_ = (tmp_path / "index_joints.csv").read_text().splitlines()[1].split(",")
    assert (name, kind) == ("joint_0", "prismatic")
    (finding,) = run_checks(exported.folder, only=["ACME001"])
    assert (finding.verdict, finding.level) == ("pass", "L2")
    assert finding.value > finding.threshold == 0.08
    assert choose_engines("mujoco-again", ()) == (EngineChoice(name="mujoco-again", python=None),)
    checks = ask_engines(exported.folder, (EngineChoice(name="mujoco-again", python=None),), 120.0)
    assert {check.verdict for check in checks} <= {"pass", "not_applicable"}, checks
    assert any(check.verdict == "pass" for check in checks)


@pytest.mark.parametrize(
    ("group", "name", "value", "said"),
    [
        ("artigen.kinds", "CardIndex", "artigen_card_index:NOTHING", "cannot be loaded: AttributeError"),
        ("artigen.kinds", "CardIndex", "artigen_card_index:draw", "is a function, expected a Kind"),
        ("artigen.kinds", "Oven", "artigen.kinds.oven:KIND", "kind Oven: .*Oven.* exist"),
        ("artigen.checks", "V101", "sim_export.checks.suite:CHECKS", "is a tuple, expected a CheckSpec"),
        ("artigen.engines", "mujoco", "artigen_card_index.engine:ENGINE", "'mujoco' exists already"),
        ("artigen.exporters", "usd", "artigen_card_index.joints:write_joints", "'usd' exists already"),
    ],
)
def test_what_is_wrong_with_an_extension_is_said_with_its_name(install, group, name, value, said):
    from artigen.api.formats import find_exporters

    install({group: {name: value}})
    look = {
        "artigen.kinds": kinds, "artigen.checks": find_checks, "artigen.engines": find_witnesses,
        "artigen.exporters": find_exporters,
    }[group]  # fmt: skip
    with pytest.raises(ArtigenError, match=f"artigen-card-index: .*{said}"):
        look()


def test_a_check_with_a_known_id_is_refused(install, monkeypatch):
    install()
    from artigen_card_index import check as added

    monkeypatch.setattr(added, "CHECK", replace(added.CHECK, id="V101"))
    with pytest.raises(PluginError, match="check V101 of L2: expected an id that is not taken"):
        find_checks()


def test_an_unknown_format_lists_what_there_is(tmp_path: Path):
    with pytest.raises(ArtigenError, match="'obj': expected package, glb, robosuite, usd"):
        artigen.sample("Oven", 0).export(tmp_path / "oven", formats=("obj",))
