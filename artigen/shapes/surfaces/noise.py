"""Noise as a function of position: integer hashes on a lattice, smoothly interpolated.

Stateless and without tables: the same numbers on every platform, for numpy arrays and torch tensors alike.
``xp`` is the namespace of the arrays (`array_api_compat.array_namespace`).
"""

from itertools import product
from types import ModuleType
from typing import Any

PRIMES = (374761393, 668265263, 1274126177)
"""Multipliers of the lattice coordinates in the hash."""


def hash_unit(xp: ModuleType, numbers: Any) -> Any:
    """Uniform numbers in [0, 1) from int32 numbers; deterministic."""
    value = numbers ^ (numbers >> 15)
    value = value * 739982445  # products wrap around, on every platform
    value = value ^ (value >> 12)
    value = value * 695872825
    value = value ^ (value >> 15)
    return xp.astype(value & 0xFFFFFF, xp.float32) * (1.0 / 0x1000000)


def lattice_noise(xp: ModuleType, seed: Any, *coordinates: Any) -> Any:
    """Smooth noise in [0, 1] with mean one half and a correlation length of about one.

    Args:
        xp: The arrays' namespace.
        seed: int32 per point, selects the noise field.
        coordinates: One float32 array per dimension, one to three of them.
    """
    number, near, far = seed, [], []
    for coordinate, prime in zip(coordinates, PRIMES, strict=False):
        cell = xp.floor(coordinate)
        number = number + xp.astype(cell, xp.int32) * prime
        share = coordinate - cell
        share = share * share * (3.0 - 2.0 * share)
        near.append(1.0 - share)
        far.append(share)
    total = 0.0
    for corner in product((0, 1), repeat=len(coordinates)):
        step, weight = 0, 1.0
        for axis, upper in enumerate(corner):
            step += PRIMES[axis] * upper
            weight = weight * (far[axis] if upper else near[axis])
        step = (step + 2**31) % 2**32 - 2**31
        total = total + weight * hash_unit(xp, number + step)
    return total


def smooth_step(xp: ModuleType, low: float, high: float, value: Any) -> Any:
    """0 below ``low``, 1 above ``high``, smooth between."""
    share = xp.clip((value - low) / (high - low), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)
