"""Plots the metrics of a stage as SVG: one small panel each."""

import math
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from artigen.runtime.journal import read_lines

METRICS = "metrics.jsonl"
WIDTH, HEIGHT, MARGIN, COLUMNS = 300, 170, 34, 3
"""Of a panel, in pixels; panels in a row."""
AXES = ("step", "minutes", "share")
"""How far a run has come; not drawn."""
MAX_POINTS = 400
"""Points drawn on a curve; longer ones are thinned."""


def read_metrics(path: Path) -> list[dict[str, float]]:
    """The lines of a stage in the order of their steps.

    A run that went on from a checkpoint has done some steps again: the later line counts. A line cut
    short is left out.
    """
    lines = {line["step"]: line for line in read_lines(path)}
    return [lines[step] for step in sorted(lines)]


def draw_curves(lines: Sequence[Mapping[str, float]], title: str) -> str:
    """An SVG with a panel for every metric, over steps; logarithmic where it can be."""
    names = list(dict.fromkeys(name for line in lines for name in line if name not in AXES))
    rows = max(1, math.ceil(len(names) / COLUMNS))
    width, height = COLUMNS * WIDTH, rows * HEIGHT + 30
    end = f"{lines[-1]['step']:.0f} steps, {lines[-1]['minutes']:.1f} minutes" if lines else "nothing yet"
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="11">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
        f'<text x="8" y="20" font-size="14">{escape(title)}: {end}</text>',
    ]
    for number, name in enumerate(names):
        x, y = number % COLUMNS * WIDTH, number // COLUMNS * HEIGHT + 30
        points = [(line["step"], line[name]) for line in lines if name in line]
        out += _panel(points, name, x, y)
    return "\n".join([*out, "</svg>"]) + "\n"


def _panel(points: Sequence[tuple[float, float]], name: str, x: int, y: int) -> list[str]:
    points = [point for point in points if math.isfinite(point[1])]
    points = [*points[:: max(1, len(points) // MAX_POINTS)], *points[-1:]]
    logarithmic = bool(points) and min(value for _, value in points) > 0
    heights = [math.log10(value) if logarithmic else value for _, value in points]
    low, high = (min(heights), max(heights)) if heights else (0.0, 1.0)
    first, last = (points[0][0], points[-1][0]) if points else (0.0, 1.0)
    inner = (WIDTH - 2 * MARGIN, HEIGHT - 2 * MARGIN)
    places = " ".join(
        f"{x + MARGIN + inner[0] * (step - first) / max(last - first, 1e-12):.1f},"
        f"{y + MARGIN + inner[1] * (1.0 - (at - low) / max(high - low, 1e-12)):.1f}"
        for (step, _), at in zip(points, heights, strict=True)
    )
    ends = [10**value if logarithmic else value for value in (high, low)]
    said = f"{escape(name)}: {points[-1][1]:.4g}" if points else escape(name)
    return [
        f'<rect x="{x + MARGIN}" y="{y + MARGIN}" width="{inner[0]}" height="{inner[1]}" fill="none" '
        'stroke="#bbbbbb"/>',
        f'<text x="{x + MARGIN}" y="{y + MARGIN - 6}">{said}{" (log)" if logarithmic else ""}</text>',
        f'<text x="{x + MARGIN - 3}" y="{y + MARGIN + 9}" text-anchor="end" font-size="8">'
        f"{ends[0]:.2g}</text>",
        f'<text x="{x + MARGIN - 3}" y="{y + MARGIN + inner[1]}" text-anchor="end" font-size="8">'
        f"{ends[1]:.2g}</text>",
        f'<polyline points="{places}" fill="none" stroke="#1f6fb2" stroke-width="1.3"/>',
    ]
