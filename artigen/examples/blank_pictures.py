"""Pictures without any object of a known kind: parts of photographs, and drawings."""

import cv2
import numpy as np
from jaxtyping import UInt8

from artigen.examples.photometry import vary_photometry
from artigen.examples.picture_stock import Stock
from artigen.reader.labels import THINGS
from artigen.reader.network import STRIDE
from artigen.reader.targets import MARK, Picture

PHOTOGRAPHED = 0.6
"""Share that are parts of photographs."""


def draw_blank(stock: Stock, size: int, rng: np.random.Generator) -> UInt8[np.ndarray, "S S 3"]:
    """A picture without an object: part of a photograph where no front is, or drawn text, a plan, blobs."""
    if rng.random() < PHOTOGRAPHED:
        image = stock.backgrounds[int(rng.integers(len(stock.backgrounds)))]
        return vary_photometry(cv2.resize(image, (size, size)), rng)
    paper = np.full((size, size, 3), rng.integers(120, 256, 3) if rng.random() < 0.5 else 255, np.uint8)
    way = rng.integers(3)
    for _ in range(int(rng.integers(3, 20))):
        color = tuple(int(value) for value in rng.integers(0, 256, 3) // (1 if way == 2 else 3))
        (x, y), (wide, high) = rng.integers(0, size, 2).tolist(), rng.integers(6, size // 2, 2).tolist()
        if way == 0:
            text = "".join(chr(int(code)) for code in rng.integers(97, 123, int(rng.integers(5, 40))))
            cv2.putText(paper, text, (x // 3, y), int(rng.integers(8)), rng.uniform(0.3, 1.0), color, 1)
        elif way == 1:
            cv2.rectangle(paper, (x, y), (x + wide, y + high), color, int(rng.integers(1, 8)))
        else:
            angle = float(rng.uniform(0, 360))
            cv2.ellipse(paper, (x, y), (wide, high), angle, 0, int(rng.integers(120, 361)), color, -1)
    return vary_photometry(paper, rng)


def make_blank(stock: Stock, size: int, rng: np.random.Generator) -> Picture:
    """A training picture in which nothing is to be found."""
    return Picture(
        pixels=draw_blank(stock, size, rng),
        marks=np.zeros(0, MARK),
        weight=np.ones((len(THINGS), size // STRIDE, size // STRIDE), np.float32),
    )
