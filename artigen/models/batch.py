"""`TensorBatch`: records of tensors that move between devices as a whole."""

from dataclasses import dataclass, replace
from typing import Self

import torch
from torch import Tensor


@dataclass(frozen=True, kw_only=True, eq=False)
class TensorBatch:
    """A record whose tensors, and those of the batches in it, move together; other fields stay."""

    def to(self, device: torch.device | str) -> Self:
        """The same batch on another device."""
        moved = {}
        for name, value in vars(self).items():
            if isinstance(value, TensorBatch):
                moved[name] = value.to(device)
            elif isinstance(value, Tensor):
                moved[name] = value.to(device, non_blocking=True)
        return replace(self, **moved)
