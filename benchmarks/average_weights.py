"""Averages the sketch networks of two models, one of which continued the training of the other.

    python benchmarks/average_weights.py BEFORE AFTER --out MODEL --share 0.75

Networks that were trained from the same start can be averaged weight by weight, and often score better than
both (Wortsman et al. 2022, "Model soups"). Words that only the second has learned
keep its weights. Prints the nats of held-out objects of each of the three.
"""

import sys
from pathlib import Path

import torch
import tyro

from artigen.examples.sketch import make_examples
from artigen.models.description import hash_model
from artigen.sketch.model import load_sketch_network, save_sketch_network
from artigen.sketch.network import SketchNetwork
from artigen.train.sketch import MEASURED, score_examples


def average_networks(before: SketchNetwork, after: SketchNetwork, share: float) -> SketchNetwork:
    """A network whose weights lie ``share`` of the way from one network to the other.

    Raises:
        ValueError: If the networks differ in size, or the share is not between 0 and 1.
    """
    if before.cfg != after.cfg or not 0.0 <= share <= 1.0:
        raise ValueError(f"share {share} of {after.cfg} and {before.cfg}: expected equal sizes, 0 to 1")
    weights = after.state_dict()
    out = SketchNetwork(before.cfg)
    out.categories, out.part_counts = after.categories, after.part_counts
    out.load_state_dict(
        {name: torch.lerp(value, weights[name], share) for name, value in before.state_dict().items()}
    )
    return out.eval()


def main(
    models: tyro.conf.Positional[tuple[Path, Path]],
    out: Path,
    data: Path,
    preset: str = "small",
    share: float = 0.75,
) -> None:
    """Writes the average and prints what it, and the two, cost.

    Args:
        models: Folders of the models before and after further training.
        out: Folder of the model to write.
        data: Folder for tables and pictures of held-out objects.
        preset: Name of their sizes, for the description.
        share: How much of the second model.
    """
    after = load_sketch_network(models[1])
    before = load_sketch_network(models[0], like=after)
    categories = after.categories
    count = -(-MEASURED // len(categories))
    examples = make_examples(data, 0, 1, categories=categories, count=count, workers=1, photos=True)
    networks = [before, after, average_networks(before, after, share)]
    scores = [score_examples(network, examples) for network in networks]
    for name, score in zip((*map(str, models), str(out)), scores, strict=True):
        print(name, {key: round(value, 4) for key, value in score.items()})
    start, end = (hash_model(folder) for folder in models)
    said = {"preset": preset, "held_out": scores[-1], "averaged": {start: 1.0 - share, end: share}}
    save_sketch_network(networks[-1], out, said)


if __name__ == "__main__":
    sys.exit(tyro.cli(main))
