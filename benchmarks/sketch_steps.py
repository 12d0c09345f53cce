"""Training steps of the sketch network that sum the losses of several batches (`train_sketch_gpu`)."""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from artigen.examples.sketch import SketchBatch
from artigen.examples.sketch_photos import EDGE
from artigen.sketch.network import SketchNetwork
from artigen.train.sketch_losses import SketchLosses, guessing_losses, reading_losses, vary_batch


@dataclass(frozen=True, kw_only=True, eq=False)
class SketchStep:
    """Several batches for one step of the training, by name."""

    batches: Mapping[str, SketchBatch]

    def to(self, device: torch.device | str) -> "SketchStep":
        """The same batches on another device."""
        return SketchStep(batches={name: batch.to(device) for name, batch in self.batches.items()})


class StepLosses(nn.Module):
    """The weighted losses of several batches; their pictures are encoded together, which takes less time.

    Args:
        weights: Weight of the losses of each batch, by its name.
    """

    def __init__(self, network: SketchNetwork, weights: Mapping[str, float]) -> None:
        super().__init__()
        self.each, self.weights = SketchLosses(network), weights

    def forward(self, step: SketchStep) -> dict[str, Tensor]:
        """The terms of `SketchLosses` of each batch, weighted, with the name of their batch."""
        photos = {name: batch.photos for name, batch in step.batches.items() if batch.photos is not None}
        images = [one.image for one in photos.values()]
        seen, memory = self.each.network.encode_pictures(torch.cat(images)) if images else (None, None)
        terms, start = dict[str, Tensor](), 0
        for name, batch in step.batches.items():
            own, part = {}, None
            if batch.photos is not None and seen is not None and memory is not None:
                here = slice(start, start + len(batch.photos.image))
                start, part = here.stop, memory[here]
                own = reading_losses(seen[here], batch.photos) | guessing_losses(seen[here], batch.rows)
            own |= self.each.rate_rows(batch.rows, part)
            terms |= {f"{name} {term}": self.weights[name] * value for term, value in own.items()}
        return terms


def step_losses(
    network: nn.Module, step: SketchStep, generator: torch.Generator, edge: int = EDGE
) -> dict[str, Tensor]:
    """Loss terms of the batches of a step, after augmentation of their pictures to ``edge`` pixels."""
    varied = {name: vary_batch(batch, generator, edge) for name, batch in step.batches.items()}
    return network(SketchStep(batches=varied))
