"""``ArtiGen-OpenPart-v1``: open, or close, a drawer or a door; turn, press, lift or slide any part."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import torch

from .objects import HandleNeed, PartKind, TaskObject, TaskPart, Validation, say_part
from .task import PackageTask
from .verbs import Verb

STARTS = {"open": 0.0, "close": 0.75}
GOALS = {"open": 0.75, "close": 0.05}


class OpenPartEnv(PackageTask):
    """A robot opens or closes one drawer or door of an object, or turns, presses, lifts or slides a part.

    A latched leaf takes two motions: its handle or bolt first. Low objects stand on a plinth.

    **Randomizations:** the object, the part, the robot's base (2 cm, 3 degrees around a place from which the
    part is in reach) and its joints (0.02 rad).

    **Success:** the part is open to at least ``fraction`` of its range (to close: at most ``fraction``) and
    moves by at most 0.1 m/s or 1 rad/s.

    **Observations:** robot state, ``tcp_pose``; with states also ``open_fraction``, ``goal_fraction``,
    ``grip_position``, ``tcp_to_grip`` and ``pull_direction``.

    Args:
        packages: A folder of packages, one package, or a list of either.
        part: ``drawer``, ``door``, another label, or ``any`` part that the verb applies to.
        verb: ``open`` selects drawers and doors; ``turn``, ``press``, ``lift`` and ``slide`` select parts by
            motion.
        joint: Only parts on a joint with this name.
        goal: ``open`` or ``close``.
        fraction: Goal fraction of the range; default: 0.75 to open and 0.05 to close.
        initial_open: Initial open fraction; default: 0 to open and 0.75 to close.
        handles: ``required`` excludes parts without an annotated handle.
        latches: ``closed`` (only if the part is initially closed) or ``open``.
        validation: ``any`` accepts packages without a passed ``validation.json``.
        kwargs: Arguments of ManiSkill's environments.

    Raises:
        TaskError: If there is no package, one failed validation, or none has the part.
    """

    full_reward = 5.0

    def __init__(
        self,
        *args: Any,
        packages: str | Path | Sequence[str | Path],
        part: PartKind = "any",
        joint: str | None = None,
        verb: Verb = "open",
        goal: Literal["open", "close"] = "open",
        fraction: float | None = None,
        initial_open: float | None = None,
        handles: HandleNeed = "optional",
        latches: Literal["closed", "open"] = "closed",
        validation: Validation = "passed",
        **kwargs: Any,
    ) -> None:
        if goal not in GOALS:
            raise ValueError(f"goal {goal!r}, expected 'open' or 'close'")
        begin = STARTS[goal] if initial_open is None else initial_open
        end = GOALS[goal] if fraction is None else fraction
        if (end <= begin) if goal == "open" else (end >= begin):
            raise ValueError(f"to {goal} from {begin} to {end} of the range: nothing is left to do")
        self.goal = goal
        self.word = goal if verb == "open" else verb
        super().__init__(
            *args, packages=packages, part=part, joint=joint, handles=handles, validation=validation,
            initial_open=begin, goal_open=end, verb=verb, plinths=True,
            latched=latches == "closed" and goal == "open" and begin == 0.0, **kwargs,
        )  # fmt: skip

    def _say(self, entry: TaskObject, part: TaskPart) -> str:
        return f"{self.word} {say_part(entry, part)}"

    def evaluate(self) -> dict[str, torch.Tensor]:
        """Named booleans and the part's state, batched."""
        info = self._part_info()
        opened = info["open_fraction"]
        arrived = opened >= self.goal_open if self.goal == "open" else opened <= self.goal_open
        progress = (opened - self.initial_open) / (self.goal_open - self.initial_open)
        return info | {
            "arrived": arrived,
            "progress": progress.clamp(0.0, 1.0),
            "success": arrived & info["part_still"],
        }

    def _get_obs_extra(self, info: dict) -> dict[str, torch.Tensor]:
        obs = super()._get_obs_extra(info)
        if "state" in self.obs_mode:
            obs["goal_fraction"] = torch.full_like(obs["open_fraction"], self.goal_open)
        return obs

    def compute_dense_reward(self, obs: Any, action: torch.Tensor, info: dict) -> torch.Tensor:
        """Up to 1 for reaching the grip, 3 for progress, 5 on success."""
        distance = torch.linalg.norm(self.agent.tcp.pose.p - info["grip_position"], dim=1)
        reward = 1.0 - torch.tanh(5.0 * distance) + 3.0 * info["progress"]
        return torch.where(info["success"], torch.full_like(reward, self.full_reward), reward)
