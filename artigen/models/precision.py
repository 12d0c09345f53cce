"""Number types that the hardware computes with natively."""

import torch


def autocast_type(device: torch.device) -> torch.dtype | None:
    """bfloat16 if the hardware supports it, else None: emulated convolutions are a hundred times slower."""
    if device.type == "cuda":
        return torch.bfloat16 if torch.cuda.is_bf16_supported() else None
    native = torch.cpu._is_avx512_bf16_supported() or torch.cpu._is_amx_tile_supported()
    return torch.bfloat16 if native else None


def native_autocast(device: torch.device) -> torch.autocast:
    """Autocast to `autocast_type`; where there is none, full precision."""
    number_type = autocast_type(device)
    return torch.autocast(device.type, number_type or torch.bfloat16, enabled=number_type is not None)
