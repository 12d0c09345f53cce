"""The training loop: budgets in minutes or steps, EMA, checkpoints that resume, metrics on disk.

A stage is a folder: ``metrics.jsonl``, ``checkpoint.pt`` (everything needed to resume) and
``weights.safetensors`` (the EMA weights); all but the first are written at the end and with every checkpoint.
"""

import json
import logging
import math
import pickle
import time
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from tqdm import tqdm

from artigen.errors import SourceError
from artigen.models.precision import autocast_type
from artigen.models.tensors import load_strictly

logger = logging.getLogger(__name__)
METRICS = "metrics.jsonl"
BAR = "{desc} {percentage:3.0f} %|{bar}| {postfix}"
CHECKPOINT = {"network", "optimizer", "average", "step", "elapsed"}
"""Keys of a checkpoint."""


@dataclass(frozen=True, kw_only=True)
class Rates:
    """How fast a network learns."""

    learning_rate: float = 1e-3
    """Peak learning rate."""
    warmup: int = 100
    """Steps over which the learning rate rises."""
    decay: float = 1.0
    """Share of the run, at its end, over which the learning rate falls as a cosine."""
    ema: float = 0.999
    """Decay of the averaged weights."""


@dataclass(frozen=True, kw_only=True)
class LoopConfig(Rates):
    """Budget, rates and bookkeeping of a loop."""

    minutes: float | None = None
    """Wall time of the run over all its starts; the learning rate is zero at its end."""
    steps: int | None = None
    """Steps of the run; give minutes or steps."""
    weight_decay: float = 0.0
    """Weight decay of AdamW."""
    clip: float = 1.0
    """Largest norm of the gradient."""
    report_every: int = 20
    """Steps between lines of metrics; losses are means over these."""
    checkpoint_minutes: float = 3.0
    """Wall time between checkpoints."""
    seed: int = 0
    """Seed of all random numbers of the loop."""

    def __post_init__(self) -> None:
        if (self.minutes is None) == (self.steps is None):
            raise ValueError(f"minutes {self.minutes} and steps {self.steps}: give one of them")


LossFunction = Callable[[nn.Module, Any, torch.Generator], dict[str, Tensor]]
"""Named, weighted terms of the loss of one batch; all randomness comes from the generator."""


@dataclass(kw_only=True)
class _Progress:
    step: int = 0
    elapsed: float = 0.0

    def share(self, cfg: LoopConfig) -> float:
        if cfg.minutes is not None:
            return self.elapsed / (60.0 * cfg.minutes)
        return self.step / max(cfg.steps or 1, 1)


def process_seed(seed: int) -> int:
    """Seed for the batches of this process, so that several GPUs train on different objects."""
    from accelerate import PartialState

    return seed + PartialState().process_index


def seed_step(generator: torch.Generator, seed: int, process: int, step: int) -> None:
    """Seeds the random numbers of one step of one process, whether or not the run was resumed before it."""
    state = np.random.SeedSequence([seed, process, step]).generate_state(1, np.uint64)
    generator.manual_seed(int(state[0]))


def train(
    network: nn.Module,
    losses: LossFunction,
    batches: Iterator[Any],
    folder: Path,
    cfg: LoopConfig,
    factors: Mapping[str, float] | None = None,
) -> nn.Module:
    """Trains until the budget is used and returns the network with its averaged weights.

    Resumes from a checkpoint in the folder. Uses several GPUs when started by ``accelerate launch``.

    Args:
        network: Network on the CPU; it is moved to the device.
        batches: Endless batches.
        factors: Factors on the learning rate of parameters, by the beginning of their names; 1 for the
            others.

    Raises:
        FloatingPointError: If the loss is not finite.
        SourceError: If the checkpoint is damaged or does not fit.
    """
    from accelerate import Accelerator

    accelerator = Accelerator(mixed_precision="no")
    device = accelerator.device
    network.to(device)
    optimizer = torch.optim.AdamW(
        _group_parameters(network, factors or {}),
        lr=cfg.learning_rate,
        weight_decay=cfg.weight_decay,
        betas=(0.9, 0.99),
        fused=device.type == "cuda",
    )
    average = {name: value.detach().clone().float() for name, value in network.state_dict().items()}
    generator = torch.Generator(device)
    progress = _Progress()
    checkpoint = folder / "checkpoint.pt"
    if checkpoint.is_file():
        stored = _read_checkpoint(checkpoint, device)
        load_strictly(network, stored["network"], str(checkpoint))
        optimizer.load_state_dict(stored["optimizer"])
        average = stored["average"]
        progress = _Progress(step=stored["step"], elapsed=stored["elapsed"])
    wrapped, optimizer = accelerator.prepare(network, optimizer)
    folder.mkdir(parents=True, exist_ok=True)
    number_type = autocast_type(device)
    started, saved = time.monotonic() - progress.elapsed, time.monotonic()
    hidden = None if accelerator.is_main_process else True  # None hides it outside of terminals
    bar = tqdm(total=100, desc=folder.name, bar_format=BAR, disable=hidden)
    sums: dict[str, tuple[Tensor, int]] = {}
    summed, since = 0, time.monotonic()
    while progress.share(cfg) < 1.0:
        rate = cfg.learning_rate * _rate(progress, cfg)
        for group in optimizer.param_groups:
            group["lr"] = rate * group["factor"]
        optimizer.zero_grad()
        batch = next(batches).to(device)
        seed_step(generator, cfg.seed, accelerator.process_index, progress.step)
        with torch.autocast(device.type, number_type or torch.bfloat16, enabled=number_type is not None):
            terms = losses(wrapped, batch, generator)
        loss = torch.stack(list(terms.values())).sum()
        accelerator.backward(loss)
        _add(sums, {"loss": loss, **terms})
        norm = nn.utils.clip_grad_norm_(network.parameters(), cfg.clip)
        optimizer.step()
        _average(average, network, min(cfg.ema, (1 + progress.step) / (10 + progress.step)))
        progress.step += 1
        progress.elapsed = time.monotonic() - started
        summed += 1
        if progress.step % cfg.report_every == 0:
            means = {name: float(value) / count for name, (value, count) in sums.items()}
            line = {
                "step": progress.step,
                "minutes": progress.elapsed / 60.0,
                "share": progress.share(cfg),
                "rate": rate,
                "seconds_per_step": (time.monotonic() - since) / summed,
                "loss": means["loss"],
                "gradient": float(norm),
                **means,
            }
            sums, summed, since = {}, 0, time.monotonic()
            if not math.isfinite(line["loss"]):
                raise FloatingPointError(f"{folder}: loss is {line['loss']} at step {progress.step}")
            if accelerator.is_main_process:
                with (folder / METRICS).open("a") as file:
                    file.write(json.dumps(line) + "\n")
                show_metrics(bar, folder.name, line)
        if accelerator.is_main_process and time.monotonic() - saved > 60.0 * cfg.checkpoint_minutes:
            _save(folder, network, optimizer, average, progress)
            saved = time.monotonic()
    if accelerator.is_main_process:
        _save(folder, network, optimizer, average, progress)
    bar.close()
    network.load_state_dict(average)
    return network.eval()


def _group_parameters(network: nn.Module, factors: Mapping[str, float]) -> list[dict[str, Any]]:
    """Parameters that learn, grouped by the factor on their learning rate."""
    groups: dict[float, list[nn.Parameter]] = {}
    for name, parameter in network.named_parameters():
        if parameter.requires_grad:
            factor = next((value for start, value in factors.items() if name.startswith(start)), 1.0)
            groups.setdefault(factor, []).append(parameter)
    return [{"params": held, "factor": factor} for factor, held in groups.items()]


def show_metrics(bar: tqdm, name: str, line: Mapping[str, float]) -> None:
    """Shows a line of metrics of the stage ``name`` in its progress bar, or logs it if that is hidden."""
    if bar.disable:
        logger.info("%s %s", name, " ".join(f"{key}={value:.4g}" for key, value in line.items()))
        return
    bar.n = min(100, round(100 * line["share"]))
    bar.set_postfix_str(
        f"step {line['step']:.0f}, loss {line['loss']:.4g}, {line['seconds_per_step']:.2f} s/step"
    )


def finished_steps(folder: Path) -> int:
    """Steps of the checkpoint of a stage; 0 if there is none."""
    checkpoint = folder / "checkpoint.pt"
    if not checkpoint.is_file():
        return 0
    return int(_read_checkpoint(checkpoint, "cpu")["step"])


def _read_checkpoint(path: Path, device: torch.device | str) -> dict[str, Any]:
    """Reads a checkpoint of `_save`.

    Raises:
        SourceError: If the file is damaged or no checkpoint.
    """
    hint = "delete it to train this stage from its start"
    if not zipfile.is_zipfile(path):  # torch's unpickler may raise any exception on other files
        raise SourceError(f"{path}: is no complete checkpoint; {hint}")
    try:
        stored = torch.load(path, map_location=device, weights_only=True)
    except (RuntimeError, pickle.UnpicklingError) as error:
        reason = str(error).splitlines()[0]
        raise SourceError(f"{path}: is no complete checkpoint ({reason}); {hint}") from error
    if not isinstance(stored, dict) or not stored.keys() >= CHECKPOINT:
        raise SourceError(
            f"{path}: is no checkpoint of this training, expected {', '.join(sorted(CHECKPOINT))}"
        )
    return stored


def _rate(progress: _Progress, cfg: LoopConfig) -> float:
    """Share of the peak learning rate: a linear rise, a plateau, a cosine to zero."""
    rise = min(1.0, (progress.step + 1) / max(cfg.warmup, 1))
    into = (progress.share(cfg) - (1.0 - cfg.decay)) / max(cfg.decay, 1e-9)
    return rise * 0.5 * (1.0 + math.cos(math.pi * min(1.0, max(0.0, into))))


def _add(sums: dict[str, tuple[Tensor, int]], terms: Mapping[str, Tensor]) -> None:
    """Adds terms to their sums, and counts them."""
    for name, value in terms.items():
        before, count = sums.get(name, (torch.zeros_like(value), 0))
        sums[name] = (before + value.detach(), count + 1)


@torch.no_grad()
def _average(average: dict[str, Tensor], network: nn.Module, decay: float) -> None:
    from torch.optim.swa_utils import get_ema_multi_avg_fn

    current = {name: value.float() for name, value in network.state_dict().items()}
    get_ema_multi_avg_fn(decay)([average[name] for name in current], list(current.values()), 0)


def _save(
    folder: Path,
    network: nn.Module,
    optimizer: torch.optim.Optimizer,
    average: dict[str, Tensor],
    progress: _Progress,
) -> None:
    """Writes checkpoint and averaged weights, each whole or not at all."""
    from safetensors.torch import save_file

    stored = {
        "network": network.state_dict(),
        "optimizer": optimizer.state_dict(),
        "average": average,
        "step": progress.step,
        "elapsed": progress.elapsed,
    }
    scratch = folder / ".checkpoint.pt"
    torch.save(stored, scratch)
    scratch.replace(folder / "checkpoint.pt")
    scratch = folder / ".weights.safetensors"
    save_file({name: value.contiguous().cpu() for name, value in average.items()}, scratch)
    scratch.replace(folder / "weights.safetensors")
