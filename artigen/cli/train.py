"""`artigen train`: from nothing to weights, in as many runs as it takes."""

import logging
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tyro
from tqdm import tqdm
from tqdm.contrib.logging import logging_redirect_tqdm

from artigen.cli.arguments import Workers


@dataclass(frozen=True, kw_only=True)
class TrainSettings:
    """What is trained, on what, and for how long."""

    preset: Literal["tiny", "small", "compact", "paper"] = "compact"
    """Sizes."""
    minutes: float = 30.0
    """Budget of the training of both networks; making data comes on top."""
    shards: int = 100
    """Shards of training data."""
    held_out: int = 2
    """Shards of held-out data."""
    objects: int = 256
    """Objects per shard."""
    partnet: Path | None = None
    """Folder with partnet_mobility/ and splits.json: its training split is mixed in. Such weights are for
    research only, as the data is."""
    real_share: float = 0.1
    """Share of real objects among the examples, by repetition."""
    latent_noise: float | None = None
    """Noise on what the VAE decodes in training, as a share of the latents' standard deviation; left out,
    that of the preset."""


def train(
    what: tyro.conf.Positional[Literal["structure", "structure-vae", "structure-flow"]],
    run: tyro.conf.Positional[Path],
    cfg: tyro.conf.OmitArgPrefixes[TrainSettings] = TrainSettings(),
    workers: Workers = 2,
) -> int:
    """Makes data, trains, measures held-out objects and stores the weights in RUN/model.

    A run that was stopped goes on where it was when the same command is given again.

    Args:
        what: Both networks of the structure model, or one of them; the flow needs the VAE.
        run: Folder for data, checkpoints, curves and weights.
        cfg: What is trained, on what, and for how long.
        workers: Processes that make data.
    """
    from artigen.train.everything import train_everything
    from artigen.train.run import RunConfig

    settings = RunConfig(folder=run, workers=workers, **vars(cfg))
    logging.getLogger("artigen.train").setLevel(logging.INFO)
    shown = sys.stderr.isatty()  # elsewhere, every line of metrics is a line of the log
    with (
        tqdm(total=100, bar_format="{desc} {percentage:3.0f} %|{bar}| {postfix}", disable=not shown) as bar,
        logging_redirect_tqdm(),
    ):
        bar.set_description_str("data", refresh=True)

        def on_report(network: str, line: Mapping[str, float]) -> None:
            bar.set_description_str(network, refresh=False)
            bar.n = min(100, round(100 * line["share"]))
            bar.set_postfix_str(
                f"step {line['step']:.0f}, loss {line['loss']:.4g}, {line['seconds_per_step']:.2f} s/step"
            )

        scores = train_everything(settings, what, on_report=on_report if shown else None)
    rows = "\n".join(f"  {name:20} {value:.4g}" for name, value in scores.items())
    sys.stdout.write(f"held-out reconstruction:\n{rows}\nweights are in {run / 'model'}\n")
    return 0
