"""Number types that the hardware computes with natively."""

import torch


def autocast_type(device: torch.device) -> torch.dtype | None:
    """bfloat16 if the hardware supports it, else None: emulated convolutions are a hundred times slower."""
    if device.type == "cuda":
        return torch.bfloat16 if torch.cuda.is_bf16_supported() else None
    native = torch.cpu._is_avx512_bf16_supported() or torch.cpu._is_amx_tile_supported()
    return torch.bfloat16 if native else None
