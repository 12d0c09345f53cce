"""Stores and loads the reader's weights."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

from artigen.errors import SourceError
from artigen.models.description import DESCRIPTION, read_description
from artigen.models.store import load_model, save_model
from artigen.reader.choice import Counts, CountShares
from artigen.reader.kind_network import KindNetwork, pack_bytes, unpack_bytes
from artigen.reader.network import ReaderConfig, ReaderNetwork
from artigen.weights import READER

NAME, KINDS = "reader", "kinds"
"""Names of the networks that find things and that name kinds."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Reader:
    """Trained networks, and what is usual of fronts."""

    network: ReaderNetwork
    kinds: KindNetwork
    counts: CountShares
    left_shares: Mapping[str, float]
    """Share of the doors with hinges at the left, of those without a door beside them, by kind."""


def save_reader(reader: Reader, folder: Path, described: Mapping[str, object]) -> list[Path]:
    """Writes weights with a description: in half precision, those of kinds in bytes; returns their files."""
    cfg = reader.network.cfg
    counts = {
        kind: {f"{doors} {drawers}": round(share, 4) for (doors, drawers), share in sorted(shares.items())}
        for kind, shares in sorted(reader.counts.items())
    }
    said = {
        **described,
        "sizes": asdict(cfg),
        "doors_and_drawers": counts,
        "left_hinged": dict(reader.left_shares),
    }
    return [
        *save_model(reader.network, folder, said, NAME),
        *save_model(reader.kinds, folder, {"variant": cfg.variant}, KINDS, pack_bytes),
    ]


@lru_cache(maxsize=2)
def load_reader(folder: Path) -> Reader:
    """The reader of a folder, loaded once per process.

    Raises:
        SourceError: If the folder holds none, or a file is damaged.
    """
    import torch

    described = read_description(folder).get(NAME)
    try:
        sizes, counts = described["sizes"], described["doors_and_drawers"]  # type: ignore[index]
        network = ReaderNetwork(ReaderConfig(**sizes))  # type: ignore[arg-type]
        shares = {
            kind: {_parse_counts(key): float(share) for key, share in shares.items()}
            for kind, shares in counts.items()  # type: ignore[union-attr]
        }
        left_shares = {kind: float(share) for kind, share in described["left_hinged"].items()}  # type: ignore[index,union-attr]
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise SourceError(
            f"{folder / DESCRIPTION}: describes no reader ({error}); give the folder of one, such as {READER}"
        ) from error
    kinds = KindNetwork(network.cfg.variant)
    load_model(network, folder, NAME)
    load_model(kinds, folder, KINDS, unpack_bytes)
    for one in (network, kinds):
        one.requires_grad_(requires_grad=False)
        one.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    return Reader(network=network, kinds=kinds, counts=shares, left_shares=left_shares)


def _parse_counts(text: str) -> Counts:
    doors, drawers = text.split()
    return int(doors), int(drawers)
