"""What the checks of the tasks do with a package: how far parts open, and how a cube is dropped."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import pytest

pytest.importorskip("mani_skill")
import torch

from envs.maniskill import checks

pytestmark = pytest.mark.sim


@pytest.fixture
def checked(monkeypatch):
    """The results for an object with two drawers, of which a robot opens some, and what was asked for."""

    def make(opened: int) -> Any:
        log, outcomes = SimpleNamespace(made={}, rooms=set(), dropped=None, steps=0), iter([True] * opened)
        parts = tuple(
            MagicMock(handle=object(), joint=SimpleNamespace(name=name, type="prismatic")) for name in "ab"
        )
        env = MagicMock()
        env.reset.return_value = (None, {"success": torch.tensor([False])})
        env.unwrapped.aims = torch.tensor([[0.1, 0.2, 0.3]])
        env.unwrapped.evaluate.return_value = {"success": torch.tensor([True])}

        def make_env(name: str, **settings: Any) -> MagicMock:
            log.made[name] = settings
            return env

        def step(action):
            log.steps += action is None
            state = {"inside": torch.tensor([True]), "cube_still": torch.tensor([True])}
            return torch.zeros(1), torch.zeros(1), False, False, state

        def room(entry, part, wanted, size):
            log.rooms.add((wanted, size))
            return object() if part is parts[0] else None

        env.step = step
        env.unwrapped.cabinet.get_qlimits.return_value = torch.ones((1, 1, 2))
        env.unwrapped.cube.set_pose = lambda pose: setattr(log, "dropped", pose.p[0].tolist())
        monkeypatch.setattr(checks, "read_object", lambda *_: SimpleNamespace(parts=parts))
        monkeypatch.setattr(checks.gym, "make", make_env)
        monkeypatch.setattr(checks, "room_when_open", room)
        monkeypatch.setattr(
            checks, "solve_open_part", lambda *_: SimpleNamespace(success=next(outcomes, False), reason="no")
        )
        log.checks = {check.id: check for check in checks.check_tasks(Path())}
        return log

    return make


@pytest.mark.parametrize(("opened", "verdict"), [(0, "fail"), (1, "pass"), (2, "pass")])
def test_a_robot_opens_one_part_at_least(checked, opened, verdict):
    check = checked(opened).checks["V401"]
    assert (check.verdict, check.value, check.threshold) == (verdict, opened, 1.0)


def test_a_cube_of_four_centimetres_is_dropped_by_three_into_what_is_open_to_nine_tenths(checked):
    log = checked(2)
    assert log.rooms == {(0.9, 0.04)}
    assert log.made["ArtiGen-PutInside-v1"]["initial_open"] == 0.9
    assert log.dropped == pytest.approx([0.1, 0.2, 0.3 + 0.02 + 0.03])
    assert log.steps == 30
    assert (log.checks["V404"].verdict, log.checks["V404"].threshold) == ("pass", 0.0)
    assert (log.checks["V402"].verdict, log.checks["V402"].threshold) == ("pass", 0.0)
