"""`artigen train`: data generation and training, resumable."""

import logging
import sys
from pathlib import Path

import tyro
from tqdm.contrib.logging import logging_redirect_tqdm

from artigen.api.train import AppearanceSettings, ReaderSettings, What, prepare_training
from artigen.cli.arguments import Workers
from artigen.runtime.cores import choose_workers
from artigen.train.settings import TrainSettings

TRAIN, APPEARANCE, READER = TrainSettings(), AppearanceSettings(), ReaderSettings()


def train(
    what: tyro.conf.Positional[What],
    run: tyro.conf.Positional[Path],
    cfg: tyro.conf.OmitArgPrefixes[TrainSettings] = TRAIN,
    workers: Workers = None,
    appearance: tyro.conf.OmitArgPrefixes[AppearanceSettings] = APPEARANCE,
    reader: tyro.conf.OmitArgPrefixes[ReaderSettings] = READER,
) -> int:
    """Generate data, train networks, score held-out objects and store the weights in RUN/model.

    Running the same command again resumes an interrupted run.

    Args:
        what: A model (reader, sketch, structure, appearance) or one of its networks; a flow needs its VAE.
        run: Run folder for data, checkpoints, metrics and weights.
        cfg: What to train, on which data and for how long.
        workers: Worker processes that generate data; default: one per available core.
        appearance: Settings of appearance only.
        reader: Settings of the reader only.
    """
    begin = prepare_training(what, run, cfg, choose_workers(workers), appearance, reader)
    logging.getLogger("artigen.train").setLevel(logging.INFO)
    with logging_redirect_tqdm():
        scores = begin()
    if scores:
        rows = "\n".join(f"  {name:20} {value:.4g}" for name, value in scores.items())
        sys.stdout.write(f"held-out objects:\n{rows}\n")
    sys.stdout.write(f"weights are in {run / 'model'}\n")
    return 0
