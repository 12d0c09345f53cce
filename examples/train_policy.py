"""Trains a small flow policy on demonstrations of drawers, and counts on how many objects it succeeds.

    python examples/train_policy.py out/demos/lerobot out/cabinets --unseen 0.2 --minutes 30

The policy sees the state: the robot's joints, and the grip and the pull direction in the frame of the hand.
It draws the next actions together, plays half of them, and looks again. docs/how-to/policy.md has the
commands before, and what it reaches.
"""

import argparse
import json
import time
from collections import deque
from pathlib import Path

import numpy as np
import pyarrow.parquet as parquet
import torch
from torch import nn

CHUNK, PLAYED = 16, 8
"""Actions that are drawn together, and of these played before the next look."""
STEPS = 200
"""Control steps of an episode that is judged, 0.05 s each; demonstrations take 80."""
PAST = (0, 2, 6)
"""Steps back of what is seen, in control steps of 0.05 s."""
ARM = 7
DRAWS = 8
"""Steps of integration from noise to actions."""
SHAKE = 0.01
"""Noise on the arm's joints in training, rad: actions are relative to them, so that they lead back."""


def see(qpos: np.ndarray, tcp_pose: np.ndarray, grip: np.ndarray, pull: np.ndarray, opened: np.ndarray):
    """What the policy sees of T states, (T, 20).

    Args:
        qpos: Joints of the robot, (T, 9).
        tcp_pose: Position and quaternion (wxyz) of the hand in the world, (T, 7).
        grip: From the hand to the grip in the world, m, (T, 3).
        pull: Direction of the pull in the world, (T, 3).
        opened: Open fraction, (T, 1).
    """
    w, v = tcp_pose[:, 3:4], -tcp_pose[:, 4:7]  # of the inverse rotation

    def into_hand(x: np.ndarray) -> np.ndarray:
        twice = 2.0 * np.cross(v, x)
        return x + w * twice + np.cross(v, twice)

    up = np.broadcast_to((0.0, 0.0, 1.0), grip.shape)
    return np.concatenate(
        [qpos, into_hand(grip), into_hand(pull), into_hand(up), grip[:, 2:] + tcp_pose[:, 2:3], opened],
        axis=1,
    ).astype(np.float32)


class Flow(nn.Module):
    """Velocity of a chunk of actions on the way from noise to data, given what is seen."""

    def __init__(self, seen: int, width: int = 256) -> None:
        super().__init__()
        self.seen = seen
        self.into = nn.Linear(seen + CHUNK * (ARM + 1) + 1, width)
        self.blocks = nn.ModuleList(
            nn.Sequential(nn.LayerNorm(width), nn.Linear(width, width), nn.SiLU(), nn.Linear(width, width))
            for _ in range(4)
        )
        self.out = nn.Linear(width, CHUNK * (ARM + 1))
        for name, size in (("seen", seen), ("actions", ARM + 1)):
            self.register_buffer(f"{name}_mean", torch.zeros(size))
            self.register_buffer(f"{name}_scale", torch.ones(size))

    def forward(self, seen: torch.Tensor, chunk: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        """Velocity (B, CHUNK, 8) of normalised actions at times t (B, 1) in [0, 1]."""
        seen = (seen - self.seen_mean) / self.seen_scale
        x = self.into(torch.cat([seen, chunk.flatten(1), t], dim=1))
        for block in self.blocks:
            x = x + block(x)
        return self.out(x).view_as(chunk)

    @torch.no_grad()
    def draw(self, seen: torch.Tensor) -> torch.Tensor:
        """Chunks (B, CHUNK, 8): changes of the arm's joints from now on, rad, and the gripper's action."""
        x = torch.randn(len(seen), CHUNK, ARM + 1)
        for k in range(DRAWS):
            x = x + self(seen, x, torch.full((len(seen), 1), k / DRAWS)) / DRAWS
        return x * self.actions_scale + self.actions_mean


def load(folder: Path) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor, int]:
    """What is seen (N, S), the arm's joints (N, 7), chunks of absolute actions (N, CHUNK, 8), and the number
    of episodes."""
    names = json.loads((folder / "meta" / "info.json").read_text())["features"]
    names = names["observation.environment_state"]["names"]
    table = parquet.read_table(folder / "data").to_pandas()
    seen, arms, chunks = [], [], []
    for _, episode in table.groupby("episode_index"):
        qpos, state, action = (
            np.stack(episode[key]) for key in ("observation.state", "observation.environment_state", "action")
        )
        parts = [
            state[:, [k for k, each in enumerate(names) if each.rsplit("_", 1)[0] == name]]
            for name in ("tcp_pose", "tcp_to_grip", "pull_direction", "open_fraction")
        ]
        now, steps = see(qpos, *parts), np.arange(len(qpos))
        seen.append(np.concatenate([now[np.maximum(steps - past, 0)] for past in PAST], axis=1))
        arms.append(qpos[:, :ARM])
        chunks.append(action[np.minimum(steps[:, None] + np.arange(CHUNK), len(steps) - 1)])
    a, b, c = (torch.from_numpy(np.concatenate(each)).float() for each in (seen, arms, chunks))
    return a, b, c, len(seen)


def train(folder: Path, minutes: float, start: Flow | None) -> Flow:
    """A policy trained for minutes of processor time, from ``start`` on, with averaged weights."""
    seen, arms, chunks, episodes = load(folder)
    model = start or Flow(seen.shape[1])
    relative = chunks.clone()
    relative[..., :ARM] -= arms[:, None]
    model.seen_mean, model.seen_scale = seen.mean(0), seen.std(0).clamp_min(1e-2)
    model.actions_mean, model.actions_scale = (
        relative.mean((0, 1)),
        relative.std((0, 1)).clamp_min(1e-2),
    )
    optimizer = torch.optim.AdamW(model.parameters(), lr=1e-3, weight_decay=1e-3)
    mean = torch.optim.swa_utils.AveragedModel(
        model, multi_avg_fn=torch.optim.swa_utils.get_ema_multi_avg_fn(0.999)
    )
    begin, step, losses = time.process_time(), 0, deque(maxlen=1000)
    while (share := (time.process_time() - begin) / (60.0 * minutes)) < 1.0:
        for group in optimizer.param_groups:
            group["lr"] = 1e-3 * min(1.0, (step + 1) / 500) * 0.5 * (1.0 + np.cos(np.pi * share))
        rows = torch.randint(len(seen), (256,))
        shake = SHAKE * torch.randn(len(rows), ARM)
        looked = seen[rows].clone()
        looked[:, :ARM] += shake
        data = relative[rows].clone()
        data[..., :ARM] -= shake[:, None]
        data = (data - model.actions_mean) / model.actions_scale
        noise, t = torch.randn_like(data), torch.rand(len(rows), 1)
        mixed = t[:, :, None] * data + (1.0 - t[:, :, None]) * noise
        loss = (model(looked, mixed, t) - (data - noise)).square().mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        mean.update_parameters(model)
        losses.append(loss.item())
        step += 1
    print(f"{episodes} episodes, {len(seen)} frames, {step} steps, loss {np.mean(losses):.3f}")
    return mean.module


class Player:
    """The policy as a function of observations; it plays a part of each chunk before it draws another."""

    def __init__(self, model: Flow) -> None:
        self.model = model.eval()
        self.reset()

    def reset(self) -> None:
        """Forgets the episode."""
        self.past: deque[np.ndarray] = deque(maxlen=max(PAST) + 1)
        self.queue: list[np.ndarray] = []

    def __call__(self, observation: dict) -> np.ndarray:
        agent, extra = observation["agent"], observation["extra"]
        names = ("tcp_pose", "tcp_to_grip", "pull_direction", "open_fraction")
        qpos = agent["qpos"].numpy()
        self.past.appendleft(see(qpos, *(extra[name].numpy() for name in names))[0])
        if not self.queue:
            seen = np.concatenate([self.past[min(past, len(self.past) - 1)] for past in PAST])
            chunk = self.model.draw(torch.from_numpy(seen)[None])[0].numpy()
            chunk[:, :ARM] += qpos[0, :ARM]
            self.queue = list(chunk[:PLAYED])
        return self.queue.pop(0)


def main() -> None:
    """Trains, or loads, a policy and plays it on objects of the demonstrations and on unseen ones."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("demos", type=Path)
    parser.add_argument("packages", type=Path)
    parser.add_argument("--unseen", type=float, default=0.2, help="as in artigen demos")
    parser.add_argument("--minutes", type=float, default=30.0, help="of one core; 0: only play --weights")
    parser.add_argument("--repeats", type=int, default=2, help="episodes on each object")
    parser.add_argument("--weights", type=Path, default=Path("out/policy.pt"), help="continued if there")
    args = parser.parse_args()

    import gymnasium as gym

    import envs  # noqa: F401  registers the tasks
    from envs.evaluate import evaluate
    from envs.split import split_objects

    torch.manual_seed(0)
    model = None
    if args.weights.is_file():
        state = torch.load(args.weights, weights_only=True)
        model = Flow(len(state["seen_mean"]))
        model.load_state_dict(state)
    if args.minutes or model is None:
        model = train(args.demos, args.minutes, model)
        args.weights.parent.mkdir(parents=True, exist_ok=True)
        torch.save(model.state_dict(), args.weights)
    player = Player(model)
    split = split_objects(args.packages, args.unseen)
    for name, folders in (("train", split.train), ("unseen", split.unseen)):
        env = gym.make(
            "ArtiGen-OpenPart-v1", packages=[str(folder) for folder in folders], part="drawer",
            handles="required", robot_uids="panda", obs_mode="state_dict", control_mode="pd_joint_pos",
            sim_backend="physx_cpu", render_backend="none", max_episode_steps=STEPS,
        )  # fmt: skip
        trials = evaluate(env, player, seed=10_000, repeats=args.repeats, start=player.reset)
        good = sum(trial.success for trial in trials)
        print(f"{name}: {good} of {len(trials)} episodes on {len(folders)} objects succeed")
        env.close()


if __name__ == "__main__":
    main()
