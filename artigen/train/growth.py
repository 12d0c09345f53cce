"""Growth of a trained sketch network: added blocks change nothing until they are trained."""

import torch
from torch import Tensor

from artigen.errors import ArtigenError
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig


def grow_network(network: SketchNetwork, cfg: SketchNetworkConfig) -> SketchNetwork:
    """A network of size ``cfg`` with the predictions of a smaller one.

    Added blocks are spread between those of the smaller network, in pairs of one that attends to pictures and
    one that does not, and contribute nothing at first.

    Raises:
        ArtigenError: If ``cfg`` differs in more than blocks and the picture's edge, or has fewer blocks.
    """
    grown = SketchNetwork(cfg)
    grown.categories, grown.part_counts = network.categories, network.part_counts
    grown.unlearned.copy_(network.unlearned)
    places = _spread(network.cfg.layers, cfg.layers)
    weights = {_rename(name, places): value for name, value in network.state_dict().items()}
    fresh = grown.state_dict()
    wrong = [name for name, value in weights.items() if name not in fresh or fresh[name].shape != value.shape]
    if wrong:
        raise ArtigenError(
            f"{network.cfg} does not grow to {cfg}: only blocks can be added ({wrong[0]} differs)"
        )
    added = {name: torch.zeros_like(value) for name, value in fresh.items() if _writes(name, weights)}
    grown.load_state_dict(fresh | added | weights)
    return grown


def _spread(before: int, after: int) -> list[int]:
    """New place of every block; pairs of blocks stay together."""
    if after < before or before % 2 or after % 2:
        raise ArtigenError(
            f"{before} blocks do not grow to {after}, expected even numbers, the second larger"
        )
    pairs, more = before // 2, after // 2
    return [2 * (pair * more // pairs) + k for pair in range(pairs) for k in range(2)]


def _rename(name: str, places: list[int]) -> str:
    """Name of a weight in the grown network."""
    head, _, rest = name.partition(".")
    if head != "blocks":
        return name
    index, _, rest = rest.partition(".")
    return f"blocks.{places[int(index)]}.{rest}"


def _writes(name: str, old: dict[str, Tensor]) -> bool:
    """Whether a weight is the last one of an added block."""
    last = (".out.weight", ".feed.down.weight")
    return name not in old and "blocks." in name and name.endswith(last)
