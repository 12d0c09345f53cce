"""Training: a loop that can be stopped anywhere, and what the networks of structure learn in it."""

import itertools
import json
from dataclasses import dataclass, replace
from pathlib import Path

import accelerate
import numpy as np
import pytest
import torch

from artigen.errors import SourceError
from artigen.examples.structure import StructureExample, draw_example
from artigen.latent.presets import PRESETS
from artigen.latent.structure_flow import StructureFlow
from artigen.latent.structure_vae import StructureVae
from artigen.runtime.journal import read_lines
from artigen.train.decoder import guess_latents, train_decoder
from artigen.train.loop import LoopConfig, seed_step, train
from artigen.train.structure import encode_examples, latent_batch, measure_latents
from artigen.train.structure_losses import StructureLossConfig


@pytest.fixture(scope="module")
def examples() -> list[StructureExample]:
    return [draw_example("Microwave", seed, resolution=32, image_size=32)[1] for seed in (0, 1)]


@dataclass(frozen=True)
class Points:
    """A batch that can be moved."""

    x: torch.Tensor

    def to(self, device: torch.device) -> "Points":
        return Points(self.x.to(device))


def fit(folder: Path, steps: int, total: int) -> torch.nn.Module:
    """Learns y = 2 x for ``steps`` of ``total``, always with the same batches."""
    torch.manual_seed(0)
    network = torch.nn.Linear(1, 1)
    cfg = LoopConfig(steps=total, learning_rate=0.2, warmup=2, ema=0.5, report_every=10)
    done = 0

    def losses(wrapped: torch.nn.Module, batch: Points, generator: torch.Generator) -> dict:
        nonlocal done
        done += 1
        if done > steps:
            raise KeyboardInterrupt
        jitter = 0.01 * torch.randn(1, generator=generator)
        return {"square": ((wrapped(batch.x) - 2.0 * batch.x + jitter) ** 2).mean()}

    cfg = replace(cfg, checkpoint_minutes=0.0)
    return train(network, losses, itertools.repeat(Points(torch.linspace(-1, 1, 8)[:, None])), folder, cfg)


def test_every_step_of_every_process_has_random_numbers_of_its_own():
    def draw(seed: int, process: int, step: int) -> tuple[float, ...]:
        generator = torch.Generator()
        torch.rand(step + 3, generator=generator)
        seed_step(generator, seed, process, step)
        return tuple(torch.rand(4, generator=generator).tolist())

    places = list(itertools.product((0, 1), (0, 1, 2), (0, 1, 500)))
    assert len({draw(*place) for place in places}) == len(places)
    assert [draw(*place) for place in places] == [draw(*place) for place in places]


@pytest.mark.parametrize("process", [0, 3])
def test_a_run_that_is_stopped_ends_like_one_that_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, process: int
):
    monkeypatch.setattr(accelerate.Accelerator, "process_index", property(lambda _: process))
    whole = fit(tmp_path / "whole", 80, 80)
    with pytest.raises(KeyboardInterrupt):
        fit(tmp_path / "parts", 30, 80)
    resumed = fit(tmp_path / "parts", 80, 80)
    for one, two in zip(whole.parameters(), resumed.parameters(), strict=True):
        torch.testing.assert_close(one, two)
    assert float(whole.weight.detach()) == pytest.approx(2.0, abs=0.1)
    assert (tmp_path / "parts" / "weights.safetensors").is_file()


def test_a_line_of_metrics_is_the_mean_of_the_steps_since_the_last(tmp_path: Path):
    network, count = torch.nn.Linear(1, 1), itertools.count(1)

    def losses(wrapped: torch.nn.Module, batch: Points, _: torch.Generator) -> dict:
        flat = 0.0 * wrapped(batch.x).sum()
        return {"number": flat + next(count), "one": flat + 1.0}

    cfg = LoopConfig(steps=6, report_every=3)
    train(network, losses, itertools.repeat(Points(torch.ones(2, 1))), tmp_path, cfg)
    lines = [json.loads(line) for line in (tmp_path / "metrics.jsonl").read_text().splitlines()]
    assert [line["number"] for line in lines] == [2.0, 5.0]
    assert [line["loss"] for line in lines] == [3.0, 6.0]


def test_a_checkpoint_that_is_cut_short_or_of_something_else_is_named(tmp_path: Path):
    fit(tmp_path / "run", 2, 2)
    path = tmp_path / "run" / "checkpoint.pt"
    whole = path.read_bytes()
    for content in (whole[: len(whole) // 2], b"", b"hello"):
        path.write_bytes(content)
        with pytest.raises(SourceError, match=r"checkpoint.pt: is no complete checkpoint; delete it"):
            fit(tmp_path / "run", 2, 4)
        assert path.read_bytes() == content
    torch.save({"step": 3}, path)
    with pytest.raises(SourceError, match="no checkpoint of this training"):
        fit(tmp_path / "run", 2, 4)
    path.write_bytes(whole)
    stored = torch.load(path)
    torch.save({**stored, "network": {"weight": torch.zeros(7, 7)}}, path)
    with pytest.raises(SourceError, match=r"weight is \[7, 7\], expected \[1, 1\]"):
        fit(tmp_path / "run", 2, 4)


def test_nothing_that_is_not_a_number_is_trained_on(tmp_path: Path):
    network = torch.nn.Linear(1, 1)
    cfg = LoopConfig(steps=3, report_every=1)
    batches = itertools.repeat(Points(torch.tensor([[float("nan")]])))
    with pytest.raises(FloatingPointError, match="loss is nan at step 1"):
        train(network, lambda n, b, g: {"square": n(b.x).mean()}, batches, tmp_path, cfg)


def test_latents_are_measured_with_their_spread():
    generator = torch.Generator().manual_seed(0)
    means = 3.0 + 2.0 * torch.randn(400, 2, 4, 4, 4, generator=generator)
    center, spread = measure_latents(means, torch.full_like(means, 1.5))
    torch.testing.assert_close(center, torch.full((2,), 3.0), atol=0.05, rtol=0)
    torch.testing.assert_close(spread, torch.full((2,), 2.5), atol=0.05, rtol=0)


@pytest.mark.slow
def test_the_decoder_learns_from_guesses_and_the_encoder_stays(
    tmp_path: Path, examples: list[StructureExample]
):
    torch.manual_seed(0)
    preset = PRESETS["tiny"]
    vae, flow = StructureVae(preset.vae), StructureFlow(preset.flow, preset.conditions)
    latents = encode_examples(vae, examples)
    before = {name: value.clone() for name, value in vae.state_dict().items()}
    flow_before = {name: value.clone() for name, value in flow.state_dict().items()}
    train_decoder(
        vae,
        flow,
        latents,
        examples,
        tmp_path,
        LoopConfig(steps=40, learning_rate=3e-3, warmup=1, report_every=1, ema=0.5),
        batch=2,
        losses=StructureLossConfig(),
        conditions=preset.conditions,
    )
    changed = {
        name.split(".")[0] for name, value in vae.state_dict().items() if (value != before[name]).any()
    }
    assert changed == {"decoder"}
    assert all(torch.equal(value, flow_before[name]) for name, value in flow.state_dict().items())
    assert all(parameter.requires_grad for parameter in vae.parameters())
    lost = [line["loss"] for line in read_lines(tmp_path / "metrics.jsonl")]
    assert np.mean(lost[-5:]) < 0.8 * np.mean(lost[:5])


def test_a_guess_without_noise_is_what_was_encoded(examples: list[StructureExample]):
    """A flow that knows the path gives every latent back, once or twice guessed."""
    preset = PRESETS["tiny"]
    vae = StructureVae(preset.vae)
    means, _ = encode_examples(vae, examples)
    drawn = latent_batch(list(enumerate(examples)), (means, torch.zeros_like(means)), preset.conditions)

    class Knowing(StructureFlow):
        def velocity(self, x, times, tokens, hint=None):
            return (x - self.normalise(means.float())) / times.reshape(-1, 1, 1, 1, 1)

    flow = Knowing(preset.flow, preset.conditions)
    guess = guess_latents(flow, drawn, drawn.outlines, torch.Generator().manual_seed(0))
    torch.testing.assert_close(guess, means.float(), atol=1e-3, rtol=0)
