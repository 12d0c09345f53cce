"""CIEDE2000: how different two colours look."""

import numpy as np
from jaxtyping import Float

WHITE = np.array([0.95047, 1.0, 1.08883])
"""XYZ of the white of sRGB (D65)."""
TO_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)


def convert_to_lab(color: Float[np.ndarray, "*N 3"]) -> Float[np.ndarray, "*N 3"]:
    """sRGB in [0, 1] to CIELAB."""
    linear = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)
    share = linear @ TO_XYZ.T / WHITE
    x, y, z = np.moveaxis(
        np.where(share > (6 / 29) ** 3, np.cbrt(share), share * (29 / 6) ** 2 / 3 + 4 / 29), -1, 0
    )
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def ciede2000(one: Float[np.ndarray, "*N 3"], other: Float[np.ndarray, "*N 3"]) -> Float[np.ndarray, "*N"]:
    """CIEDE2000 of CIELAB colours (Sharma, Wu, Dalal 2005); about 1 is just visible."""
    (l1, a1, b1), (l2, a2, b2) = np.moveaxis(one, -1, 0), np.moveaxis(other, -1, 0)
    mean = (np.hypot(a1, b1) + np.hypot(a2, b2)) / 2
    stretch = 1.5 - 0.5 * np.sqrt(mean**7 / (mean**7 + 25.0**7))
    (c1, h1), (c2, h2) = _to_polar(a1 * stretch, b1), _to_polar(a2 * stretch, b2)
    turn = np.where(c1 * c2 == 0, 0.0, (h2 - h1 + 180) % 360 - 180)
    light, chroma = l2 - l1, c2 - c1
    hue = 2 * np.sqrt(c1 * c2) * np.sin(np.radians(turn / 2))
    lightness, saturation = (l1 + l2) / 2, (c1 + c2) / 2
    middle = np.where(c1 * c2 == 0, h1 + h2, (h1 + turn / 2) % 360)
    wave = sum(
        weight * np.cos(np.radians(times * middle + shift))
        for weight, times, shift in ((-0.17, 1, -30), (0.24, 2, 0), (0.32, 3, 6), (-0.20, 4, -63))
    )
    off = (lightness - 50) ** 2
    by_light = light / (1 + 0.015 * off / np.sqrt(20 + off))
    by_chroma = chroma / (1 + 0.045 * saturation)
    by_hue = hue / (1 + 0.015 * saturation * (1 + wave))
    blue = 60 * np.exp(-(((middle - 275) / 25) ** 2))
    cross = -2 * np.sqrt(saturation**7 / (saturation**7 + 25.0**7)) * np.sin(np.radians(blue))
    return np.sqrt(by_light**2 + by_chroma**2 + by_hue**2 + cross * by_chroma * by_hue)


def _to_polar(
    a: Float[np.ndarray, "*N"], b: Float[np.ndarray, "*N"]
) -> tuple[Float[np.ndarray, "*N"], Float[np.ndarray, "*N"]]:
    """Chroma, and hue in degrees from 0 to 360."""
    return np.hypot(a, b), np.degrees(np.arctan2(b, a)) % 360
