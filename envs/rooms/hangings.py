"""What hangs on walls, as boxes: pictures, mirrors, televisions, tools, coats, towels, sockets, curtains."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from .patterns import Color, Pattern

OFF = 5e-4
"""Distance (m) between a wall and what hangs on it."""
FRAMES: tuple[Color, ...] = ((0.16, 0.15, 0.15), (0.55, 0.40, 0.28), (0.92, 0.91, 0.88))
PAINTS: tuple[tuple[Color, Color], ...] = (
    ((0.90, 0.88, 0.82), (0.30, 0.42, 0.50)), ((0.86, 0.80, 0.70), (0.62, 0.36, 0.27)),
    ((0.88, 0.90, 0.88), (0.36, 0.48, 0.38)), ((0.22, 0.28, 0.36), (0.85, 0.72, 0.45)),
)  # fmt: skip
"""Ground and shape of pictures."""
COATS: tuple[Color, ...] = ((0.20, 0.24, 0.32), (0.55, 0.30, 0.24), (0.62, 0.56, 0.44), (0.30, 0.34, 0.28))
TOOLS: tuple[tuple[float, float, float, Color], ...] = (
    (0.03, 0.28, 0.12, (0.50, 0.31, 0.20)), (0.02, 0.24, 0.05, (0.62, 0.63, 0.64)),
    (0.10, 0.42, 0.07, (0.70, 0.71, 0.73)), (0.03, 0.20, 0.03, (0.78, 0.33, 0.23)),
    (0.035, 0.3, 0.15, (0.88, 0.75, 0.40)),
)  # fmt: skip
"""Width and length of handles, width of heads (m), and colours of tools on a board."""
BLACK, SCREEN = (0.09, 0.09, 0.10), (0.05, 0.06, 0.08)
WHITE, METAL, GLASS, SKY = (0.95, 0.95, 0.94), (0.62, 0.63, 0.64), (0.80, 0.86, 0.89), (0.66, 0.80, 0.95)


@dataclass(frozen=True, kw_only=True)
class Part:
    """A box on a wall: name, from and to (along the wall, out of it, up), looks."""

    name: str
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    color: Color
    pattern: Pattern = "plain"


def draw_picture(
    at: float, size: tuple[float, float], frame: Color, paint: tuple[Color, Color], share: float
) -> list[Part]:
    """A shape on a ground in a frame; widths, heights in metres, ``share`` of the height of the shape."""
    (w, h), rim = (size[0] / 2, size[1] / 2), 0.02
    ground, shape = paint
    return [
        Part(name="picture_frame", low=(at - w, OFF, -h), high=(at + w, 0.018, h), color=frame),
        Part(
            name="picture_ground", low=(at - w + rim, 0.018, rim - h), high=(at + w - rim, 0.02, h - rim),
            color=ground,
        ),
        Part(
            name="picture_shape", low=(at - 0.6 * w, 0.02, -0.7 * h),
            high=(at + 0.6 * w, 0.021, h * (2 * share - 0.7)), color=shape,
        ),
    ]  # fmt: skip


def draw_mirror(at: float, frame: Color) -> list[Part]:
    """A mirror in a frame."""
    return [
        Part(name="mirror_frame", low=(at - 0.25, OFF, -0.35), high=(at + 0.25, 0.018, 0.35), color=frame),
        Part(
            name="mirror_glass", low=(at - 0.235, 0.018, -0.335), high=(at + 0.235, 0.02, 0.335), color=GLASS
        ),
    ]


def draw_television(at: float) -> list[Part]:
    """A screen on a mount."""
    low, high = (at - 0.57, 0.03, -0.33), (at + 0.57, 0.06, 0.33)
    return [
        Part(name="television_mount", low=(at - 0.2, OFF, -0.1), high=(at + 0.2, 0.03, 0.1), color=BLACK),
        Part(name="television_body", low=low, high=high, color=BLACK),
        Part(
            name="television_screen", low=(at - 0.555, 0.06, -0.315), high=(at + 0.555, 0.061, 0.315),
            color=SCREEN,
        ),
    ]  # fmt: skip


def draw_tools(at: float) -> list[Part]:
    """A board with tools that hang by their heads."""
    low, high = (at - 0.5, OFF, -0.32), (at + 0.5, 0.015, 0.32)
    parts = [Part(name="tools_board", low=low, high=high, color=FRAMES[1])]
    for index, (wide, long, head, color) in enumerate(TOOLS):
        x = at - 0.4 + 0.2 * index
        low, high = (x - wide / 2, 0.015, 0.2 - long), (x + wide / 2, 0.035, 0.2)
        parts.append(Part(name="tools_handle", low=low, high=high, color=color))
        low, high = (x - head / 2, 0.015, 0.2), (x + head / 2, 0.04, 0.25)
        parts.append(Part(name="tools_head", low=low, high=high, color=METAL))
    return parts


FOLDS = (
    ("loop", -0.02, 0.02, 0.07, 0.45, 0.52), ("collar", -0.045, 0.045, 0.09, 0.38, 0.47),
    ("middle", -0.035, 0.03, 0.12, -0.42, 0.4), ("left", -0.075, -0.03, 0.1, -0.4, 0.38),
    ("right", 0.025, 0.07, 0.105, -0.43, 0.37), ("left_sleeve", -0.105, -0.07, 0.08, -0.2, 0.33),
    ("right_sleeve", 0.065, 0.1, 0.09, -0.23, 0.32),
)  # fmt: skip
"""Folds of a coat on a hook: from and to along the wall, out of it, and up (m)."""


def draw_coats(at: float, rng: np.random.Generator) -> list[Part]:
    """A board with four hooks and coats on two or three of them."""
    low, high = (at - 0.45, OFF, 0.48), (at + 0.45, 0.02, 0.58)
    parts = [Part(name="coats_board", low=low, high=high, color=FRAMES[1])]
    coats = rng.permutation(4)[: int(rng.integers(2, 4))]
    for hook in range(4):
        x = at - 0.33 + 0.22 * hook
        low, high = (x - 0.01, 0.02, 0.51), (x + 0.01, 0.08, 0.53)
        parts.append(Part(name="coats_hook", low=low, high=high, color=METAL))
        if hook in coats:
            cloth = COATS[int(rng.integers(len(COATS)))]
            parts += [
                Part(
                    name=f"coats_{name}", low=(x + left, 0.03, foot - 0.08 * (hook % 2) * (foot < 0.0)),
                    high=(x + right, depth, top), color=cloth, pattern="cloth",
                )
                for name, left, right, depth, foot, top in FOLDS
            ]  # fmt: skip
    return parts


def draw_towel(at: float, cloth: Color) -> list[Part]:
    """A rail with a towel."""
    return [
        Part(name="towel_rail", low=(at - 0.25, 0.06, 0.18), high=(at + 0.25, 0.075, 0.195), color=METAL),
        Part(name="towel_left", low=(at - 0.25, OFF, 0.18), high=(at - 0.235, 0.06, 0.195), color=METAL),
        Part(name="towel_right", low=(at + 0.235, OFF, 0.18), high=(at + 0.25, 0.06, 0.195), color=METAL),
        Part(
            name="towel_cloth", low=(at - 0.2, 0.045, -0.25), high=(at + 0.1, 0.06, 0.18), color=cloth,
            pattern="cloth",
        ),
    ]  # fmt: skip


def draw_socket(at: float) -> list[Part]:
    """A socket."""
    return [Part(name="socket", low=(at - 0.04, OFF, -0.04), high=(at + 0.04, 0.01, 0.04), color=WHITE)]


def draw_curtains(hole: tuple[float, float, float, float], cloth: Color) -> Iterator[list[Part]]:
    """Ways to dress a window: a rod with a curtain on both sides, to the floor or else to below the sill, as
    near as the window opens past them; or else a blind, rolled up above it."""
    start, stop, bottom, top = hole
    for wide, beside, foot in product((0.29, 0.17), (0.05, 0.13, 0.21), (0.09, bottom - 0.1)):
        reach = beside + wide + 0.02
        parts = [
            Part(
                name="curtain_rod", low=(start - reach, 0.06, top + 0.1),
                high=(stop + reach, 0.08, top + 0.12), color=METAL,
            )
        ]  # fmt: skip
        for name, near in (("left", start - beside - wide), ("right", stop + beside)):
            folds = np.linspace(near, near + wide, 6).tolist()
            parts += [
                Part(
                    name=f"curtain_{name}", low=(a, 0.045 + 0.02 * (index % 2), foot),
                    high=(b, 0.075 + 0.02 * (index % 2), top + 0.095), color=cloth, pattern="cloth",
                )
                for index, (a, b) in enumerate(pairwise(folds))
            ]  # fmt: skip
        yield parts
    low, high = (start, OFF, top + 0.06), (stop, 0.07, top + 0.13)
    yield [Part(name="curtain_blind", low=low, high=high, color=cloth, pattern="cloth")]
