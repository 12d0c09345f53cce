"""How well pictures are read: category, counts of parts, proportions."""

from collections.abc import Sequence

import torch

from artigen.models.picture_reader import PictureReader
from artigen.train.examples import StructureExample
from artigen.train.reader import see_parts
from artigen.types import PART_LABELS


@torch.no_grad()
def score_reader(
    reader: PictureReader, examples: Sequence[StructureExample], *, batch: int = 64
) -> dict[str, float]:
    """Reads the pictures of examples; shares in [0, 1].

    ``category`` and ``counts`` are the shares of pictures read right, the latter of every label at once;
    ``counts of <label>`` those of one label; ``extents`` is the mean error of the logarithms of the extents
    as shares of the longest.
    """
    device = next(reader.parameters()).device
    rights: list[torch.Tensor] = []
    kinds: list[torch.Tensor] = []
    errors: list[torch.Tensor] = []
    for start in range(0, len(examples), batch):
        seen = see_parts(examples[start : start + batch], reader.conditions).to(device)
        said = reader(seen.image)
        rights.append(said.counts.argmax(dim=-1) == seen.counts)
        kinds.append(said.category.argmax(dim=-1) == seen.category)
        errors.append((said.log_extents - seen.log_extents).abs().mean(dim=1))
    right = torch.cat(rights).float()
    return {
        "category": float(torch.cat(kinds).float().mean()),
        "counts": float(right.amin(dim=1).mean()),
        **{
            f"counts of {label}": float(share)
            for label, share in zip(PART_LABELS, right.mean(dim=0), strict=True)
        },
        "extents": float(torch.cat(errors).mean()),
    }
