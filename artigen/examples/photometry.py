"""Changes of a picture as by a camera, a lamp and a file format."""

import cv2
import numpy as np
from jaxtyping import Float, UInt8

cv2.setNumThreads(1)
MILD = 0.4
"""Share of the pictures that stay nearly as they are."""


def smooth_noise(
    rng: np.random.Generator, size: int, cells: int, channels: int = 1
) -> Float[np.ndarray, "S S C"]:
    """Noise from 0 to 1 that varies over a few cells."""
    coarse = rng.random((cells, cells, channels), dtype=np.float32)
    return cv2.resize(coarse, (size, size), interpolation=cv2.INTER_CUBIC).reshape(size, size, channels)


def vary_photometry(
    image: UInt8[np.ndarray, "S S 3"], rng: np.random.Generator
) -> UInt8[np.ndarray, "S S 3"]:
    """Gamma, contrast, colour, uneven light, highlights, shadows, blur or sharpening, noise and JPEG."""
    size = len(image)
    strength = 0.3 if rng.random() < MILD else 1.0
    image = _vary_tones(image, rng, strength)
    if rng.random() < 0.5 * strength + 0.1:
        image = _vary_light(image, rng)
    chance = rng.random()
    if chance < 0.25:
        image = cv2.GaussianBlur(image, (0, 0), rng.uniform(0.3, 0.4 + 1.2 * strength))
    elif chance < 0.4:
        edge = int(size * rng.uniform(0.4, 1.0))
        image = cv2.resize(image, (edge, edge), interpolation=cv2.INTER_AREA)
        image = cv2.resize(image, (size, size), interpolation=cv2.INTER_LINEAR)
    elif chance < 0.65:
        more = rng.uniform(0.3, 1.5)
        image = cv2.addWeighted(image, 1 + more, cv2.GaussianBlur(image, (0, 0), 1.5), -more, 0)
    if rng.random() < 0.4:
        noise = rng.standard_normal(image.shape, dtype=np.float32) * rng.uniform(0, 12 * strength)
        image = cv2.add(image, noise, dtype=cv2.CV_8U)
    if rng.random() < 0.5:
        coded = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(25, 95))])[1]
        image = np.asarray(cv2.imdecode(coded, cv2.IMREAD_COLOR))
    return image


def _vary_tones(
    image: UInt8[np.ndarray, "S S 3"], rng: np.random.Generator, strength: float
) -> UInt8[np.ndarray, "S S 3"]:
    table = np.linspace(0, 1, 256)[:, None] ** np.exp(rng.normal(0, 0.3 * strength))
    table = (table - 0.5) * (1 + strength * rng.uniform(-0.4, 0.3)) + 0.5 + rng.normal(0, 0.08 * strength)
    table = np.clip(table * (1 + rng.normal(0, 0.08 * strength, 3)), 0, 1)
    image = cv2.LUT(image, (table * 255).astype(np.uint8)[None])
    if rng.random() < 0.6:
        grey = cv2.cvtColor(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), cv2.COLOR_GRAY2RGB)
        kept = rng.uniform(0.0 if rng.random() < 0.15 else 0.5, 1.5)
        image = cv2.addWeighted(image, kept, grey, 1 - kept, 0)
    return image


def _vary_light(image: UInt8[np.ndarray, "S S 3"], rng: np.random.Generator) -> UInt8[np.ndarray, "S S 3"]:
    """Uneven light, perhaps with a shadow's edge, dark corners or a highlight."""
    size, coarse = len(image), len(image) // 4
    gain = 1 + rng.uniform(0, 0.7) * (smooth_noise(rng, coarse, int(rng.integers(2, 5)))[..., 0] - 0.6)
    y, x = np.mgrid[0:coarse, 0:coarse] / coarse - 0.5
    if rng.random() < 0.4:
        angle, sharp = rng.uniform(0, 2 * np.pi), rng.uniform(5, 100)
        side = (x * np.cos(angle) + y * np.sin(angle) - rng.uniform(-0.3, 0.3)) * sharp
        gain = gain * (1 - rng.uniform(0.1, 0.5) / (1 + np.exp(-np.clip(side, -50, 50))))
    if rng.random() < 0.4:
        gain = gain * (1 - rng.uniform(0, 1.2) * (x**2 + y**2))
    image = np.clip(image * cv2.resize(gain.astype(np.float32), (size, size))[..., None], 0, 255).astype(
        np.uint8
    )
    if rng.random() < 0.3:
        cx, cy = rng.uniform(-0.5, 0.5, 2)
        spread = rng.uniform(0.01, 0.06)
        light = rng.uniform(20, 160) * np.exp(
            -((x - cx) ** 2 / spread + (y - cy) ** 2 / spread / rng.uniform(0.2, 4))
        )
        image = cv2.add(
            image,
            np.repeat(cv2.resize(light.astype(np.float32), (size, size))[..., None], 3, 2),
            dtype=cv2.CV_8U,
        )
    return image
