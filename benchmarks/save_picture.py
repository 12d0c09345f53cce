"""Pictures of the documentation as small files."""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image


def save_picture(image: UInt8[np.ndarray, "H W 3"], path: Path) -> None:
    """Writes a picture as a JPEG, which keeps the shades that 256 colours lose."""
    Image.fromarray(image).save(path, quality=88, optimize=True, progressive=True)
