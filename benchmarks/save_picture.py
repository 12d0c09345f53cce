"""Pictures of the documentation as small PNG files."""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image


def save_picture(image: UInt8[np.ndarray, "H W 3"], path: Path) -> None:
    """Writes a picture in 256 dithered colours: half of the bytes; a palette alone shows bands on wood."""
    full = Image.fromarray(image)
    palette = full.quantize(256, method=Image.Quantize.MAXCOVERAGE, kmeans=3)
    small = full.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
    small.save(path, optimize=True)
