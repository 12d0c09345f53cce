"""`Splats`: Gaussians as differentiable tensors, and `Rendering`: pictures of them."""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor

from artigen.splats.colors import srgb_from_linear
from artigen.types import Gaussians


@dataclass(frozen=True, kw_only=True, eq=False)
class Splats:
    """Gaussians for the rasteriser: tensors of one dtype (float32 or float64) on one device."""

    means: Float[Tensor, "N 3"]
    """Centres, in the unit of the cameras."""
    quats: Float[Tensor, "N 4"]
    """wxyz of any length above zero; normalised where they are used."""
    scales: Float[Tensor, "N 3"]
    """Standard deviations along the axes of ``quats``."""
    opacities: Float[Tensor, "N"]
    """In [0, 1]."""
    colors: Float[Tensor, "N C"]
    """Any number of channels, blended as they are. For pictures they are sRGB values, which viewers and
    TRELLIS blend as well."""

    def __post_init__(self) -> None:
        fields = vars(self)
        counts = {name: len(value) for name, value in fields.items()}
        if len(set(counts.values())) > 1:
            raise ValueError(f"splats: {counts}, expected equally many of each")
        kinds = {(value.dtype, value.device) for value in fields.values()}
        if len(kinds) > 1 or self.means.dtype not in (torch.float32, torch.float64):
            found = ", ".join(sorted(f"{dtype} on {device}" for dtype, device in kinds))
            raise ValueError(f"splats: tensors are {found}, expected float32 or float64 on one device")


@dataclass(frozen=True, kw_only=True, eq=False)
class Rendering:
    """Pictures of a batch of cameras."""

    color: Float[Tensor, "B H W C"]
    """Splats over the background."""
    alpha: Float[Tensor, "B H W"]
    """Coverage of each pixel by the splats, 0 to 1."""
    depth: Float[Tensor, "B H W"]
    """Mean depth of the splats along the viewing direction, weighted like their colours; infinite where there
    is none."""


def make_splats(gaussians: Gaussians, *, dtype: torch.dtype = torch.float32) -> Splats:
    """Tensors of an asset's Gaussians; linear colours become sRGB."""
    arrays = {
        "means": gaussians.means,
        "quats": gaussians.quats,
        "scales": gaussians.scales,
        "opacities": gaussians.opacities,
        "colors": srgb_from_linear(gaussians.colors),
    }
    return Splats(**{name: torch.tensor(array, dtype=dtype) for name, array in arrays.items()})
