"""What is printed on appliances: scales around dials, legends on keys, and digits in displays.

Prints are flat bodies a tenth of a millimetre proud of the face that they lie on, in finishes of their own,
so that they are sharp at any distance. Only visuals have them.
"""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from artigen.shapes.primitives import Primitive, contains, place_vertices
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.types import Joint
from sim_export.appearance.tiles import find_color
from sim_export.geometry.broken_edges import Cover
from sim_export.package import Mesh

FINISHES: Mapping[str, Finish] = {
    name: Finish(kind="lacquer", color=color, accent=color, gloss=0.2)
    for name, color in (
        ("print_dark", (0.16, 0.16, 0.17)),
        ("print_light", (0.86, 0.86, 0.85)),
        ("digits", (0.72, 0.9, 0.93)),
    )
}  # fmt: skip
"""Finishes of prints by role."""
PROUD, DEEP = 0.0001, 0.0002
"""How far (m) a print stands out of its face, and how far it reaches in."""
RADII = (0.008, 0.045)
"""Radii (m) of dials that have a scale."""
REACH = 0.004
"""Largest distance (m) of a dial from the face behind it."""
SCALE = (1.10, 1.17, 1.24)
"""Inner end of marks, and outer ends of small and large ones, relative to the dial."""
KEYS = (0.01, 0.05)
"""Widths (m) of keys that have a legend."""
STEPS = 10
"""Steps of the scale of a dial with limits; one without has a full circle of 12."""
LINE = 0.0009
"""Width (m) of a mark."""
DISPLAY = ((0.02, 0.05), (0.05, 0.4), 0.012)
"""Ranges (m) of height and width of a display, and its largest thickness."""
KEYPAD = ((0.06, 0.4), (0.04, 0.14), 0.015)
"""The same of a touch pad, which has three keys in a row, `PITCH` above each other."""
PITCH = 0.021
SEGMENTS = {
    "0": "abcdef", "1": "bc", "2": "abged", "4": "fgbc", "5": "afgcd", "8": "abcdefg",
}  # fmt: skip
TIME = "12:45"
OUT = np.array([-1.0, 0.0, 0.0])
"""Where displays and keys face."""
LIGHT = 0.4
"""Brightness (sRGB) of a finish above which prints on it are dark."""


def find_prints(shape: Shape) -> dict[str, dict[str, Mesh]]:
    """Prints of an object by part and finish (m, object frame); none where there is no place for them."""
    finishes, parts = dict(shape.finishes), {part.name: part for part in shape.parts}
    out: dict[str, dict[str, list[np.ndarray]]] = {}
    for part in shape.parts:
        if part.label == "knob" and part.joint is not None and part.parent is not None:
            carrier = parts[part.parent]
            for finish, bar in _scale(part, carrier, finishes):
                out.setdefault(carrier.name, {}).setdefault(finish, []).append(bar)
        for finish, bar in _legend(part, finishes):
            out.setdefault(part.name, {}).setdefault(finish, []).append(bar)
        for primitive in part.primitives:
            light = _is_light(finishes[primitive.finish])
            for bar in _digits(primitive):
                out.setdefault(part.name, {}).setdefault("print_dark" if light else "digits", []).append(bar)
            for bar in _keys(primitive):
                role = "print_dark" if light else "print_light"
                out.setdefault(part.name, {}).setdefault(role, []).append(bar)
    return {
        name: {finish: _join(bars) for finish, bars in by_finish.items()} for name, by_finish in out.items()
    }


def _scale(
    dial: ShapePart, carrier: ShapePart, finishes: Mapping[str, Finish]
) -> list[tuple[str, Float[np.ndarray, "8 3"]]]:
    """Marks around a dial on the face of its carrier, each with its finish; those off it are left out."""
    joint = dial.joint
    assert joint is not None
    rods = [one for one in dial.primitives if one.kind == "cylinder" or len(one.planes) == 12]
    if joint.type not in ("revolute", "continuous") or not rods:
        return []
    axis, center = np.asarray(joint.axis, float), np.asarray(joint.origin, float)
    radius = max(float(one.size[:2].max()) / 2 for one in rods)
    sizes = [np.abs(one.rotation.T @ axis) for one in rods]
    if not RADII[0] <= radius <= RADII[1] or any(along[2] < 0.999 for along in sizes):
        return []
    points = np.concatenate([one.vertices @ one.rotation.T + one.center for one in rods])
    heights = (points - center) @ axis
    # The dial stands out of its carrier: the face is on the side that is covered.
    for out, low in ((axis, heights.min()), (-axis, -heights.max())):
        foot = center + out * low
        for primitive in carrier.primitives:
            depth = _meet(primitive, foot + out * 1e-5, -out)
            if depth is None or depth > REACH:
                continue
            face = foot + out * 1e-5 - out * depth
            finish = "print_dark" if _is_light(finishes[primitive.finish]) else "print_light"
            bars = _marks(joint, out, face, radius)
            cover = Cover(carrier.primitives)
            return [(finish, bar) for bar in bars if _lies_on(bar, cover, out)]
    return []


def _marks(joint: Joint, out: np.ndarray, face: np.ndarray, radius: float) -> list[Float[np.ndarray, "8 3"]]:
    """A line at every step of a dial on the face behind it; at rest the dial points up, or to the back."""
    axis = np.asarray(joint.axis, float)
    up = np.array([0.0, 0.0, 1.0]) if abs(axis[2]) < 0.5 else np.array([1.0, 0.0, 0.0])
    aside = np.cross(axis, up)
    whole = joint.type == "continuous" or joint.upper > 6.2
    angles = np.arange(12) * np.pi / 6 if whole else np.linspace(0.0, joint.upper, STEPS + 1)
    inner, small, large = (share * radius for share in SCALE)
    bars = []
    for number, angle in enumerate(angles):
        ray = np.cos(angle) * up + np.sin(angle) * aside
        tip = large if number % (3 if whole else 5) == 0 else small
        bars.append(_bar(face + inner * ray, face + tip * ray, out))
    return bars


def _legend(key: ShapePart, finishes: Mapping[str, Finish]) -> list[tuple[str, Float[np.ndarray, "8 3"]]]:
    """A stroke on the front of a key, with its finish."""
    joint = key.joint
    if key.label != "knob" or joint is None or joint.type != "prismatic" or joint.axis[0] < 0.999:
        return []
    points = np.concatenate([place_vertices(one) for one in key.primitives])
    low, high = points.min(axis=0), points.max(axis=0)
    width = float(high[1] - low[1])
    if not KEYS[0] <= width <= KEYS[1]:
        return []
    middle, half = (low + high) / 2, np.array([0.0, 0.2 * width, 0.0])
    middle[0] = low[0]
    front = min(key.primitives, key=lambda one: float(place_vertices(one)[:, 0].min()))
    finish = "print_dark" if _is_light(finishes[front.finish]) else "print_light"
    return [(finish, _bar(middle - half, middle + half, OUT))]


def _digits(primitive: Primitive) -> list[Float[np.ndarray, "8 3"]]:
    """The time in the window of a display."""
    face = _find_pane(primitive, DISPLAY)
    if face is None:
        return []
    tall = 0.5 * float(primitive.size[2])
    pitch, half = 0.75 * tall, 0.22 * tall
    start = -(len(TIME) - 1) / 2 * pitch
    bars = []
    for number, letter in enumerate(TIME):
        middle = face - np.array([0.0, start + number * pitch, 0.0])  # from left to right is towards -y
        bars += [_bar(middle + a, middle + b, OUT) for a, b in _strokes(letter, half, tall / 2)]
    return bars


def _keys(primitive: Primitive) -> list[Float[np.ndarray, "8 3"]]:
    """Legends of the keys of a touch pad: a long stroke above a short one."""
    face = _find_pane(primitive, KEYPAD)
    if face is None:
        return []
    width, height = float(primitive.size[1]), float(primitive.size[2])
    rows, bars = int((height - 0.01) / PITCH), []
    for row in range(rows):
        for column in (-1, 0, 1):
            middle = face + _shift(column * width / 3.4, (row - (rows - 1) / 2) * PITCH)
            for rise, half in ((0.002, width / 16), (-0.002, width / 28)):
                bars.append(_bar(middle + _shift(-half, rise), middle + _shift(half, rise), OUT))
    return bars


def _find_pane(
    primitive: Primitive, sizes: tuple[tuple[float, float], tuple[float, float], float]
) -> Float[np.ndarray, "3"] | None:
    """The middle of the face of a thin upright block of panel glass that faces the front and has one of these
    sizes; None of anything else."""
    (low, high), (narrow, wide), thick = sizes
    depth, width, height = (float(value) for value in primitive.size)
    upright = np.array_equal(primitive.rotation, np.eye(3)) and len(primitive.planes) == 6
    if primitive.finish != "panel" or not upright or depth > thick:
        return None
    fits = low <= height <= high and narrow <= width <= wide
    return primitive.center + OUT * depth / 2 if fits else None


def _strokes(letter: str, half: float, rise: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Ends of the strokes of a letter in seven segments, relative to its middle."""
    gap = 0.0006
    if letter == ":":
        return [(_shift(0.0, z - 0.0005), _shift(0.0, z + 0.0005)) for z in (-0.4 * rise, 0.4 * rise)]
    flat = {"a": rise, "g": 0.0, "d": -rise}
    tall = {"f": (half, 1), "b": (-half, 1), "e": (half, -1), "c": (-half, -1)}
    found = []
    for segment in SEGMENTS[letter]:
        if segment in flat:
            found.append((_shift(half - gap, flat[segment]), _shift(gap - half, flat[segment])))
        else:
            y, side = tall[segment]
            found.append((_shift(y, side * gap), _shift(y, side * (rise - gap))))
    return found


def _shift(y: float, z: float) -> np.ndarray:
    return np.array([0.0, y, z])


def _bar(start: np.ndarray, end: np.ndarray, out: np.ndarray) -> Float[np.ndarray, "8 3"]:
    """Corners of a line from start to end on a face that looks along ``out``."""
    along = (end - start) / np.linalg.norm(end - start)
    aside = np.cross(out, along) * LINE / 2
    ring = np.stack([start - aside, end - aside, end + aside, start + aside])
    return np.concatenate([ring - DEEP * out, ring + PROUD * out])


def _lies_on(bar: Float[np.ndarray, "8 3"], cover: Cover, out: np.ndarray) -> bool:
    """Whether all of a bar is just below and just above a face."""
    return not cover.free(bar[:4], []).any() and bool(cover.free(bar[4:] + PROUD * out, []).all())


def _meet(primitive: Primitive, start: np.ndarray, ray: np.ndarray) -> float | None:
    """Distance (m) along a ray at which it enters a solid from outside."""
    if contains(primitive, start[None])[0]:
        return None
    own, way = (start - primitive.center) @ primitive.rotation, ray @ primitive.rotation
    height = primitive.planes[:, :3] @ own + primitive.planes[:, 3]
    slope = primitive.planes[:, :3] @ way
    with np.errstate(divide="ignore", invalid="ignore"):
        at = -height / slope
    if ((slope == 0) & (height > 0)).any():
        return None
    enter = np.max(at, initial=0.0, where=slope < 0)
    leave = np.min(at, initial=np.inf, where=slope > 0)
    return float(enter) if enter < leave else None


def _is_light(finish: Finish) -> bool:
    """Whether a dark print can be read on a finish."""
    return float(np.dot(find_color(finish), (0.3, 0.59, 0.11))) > LIGHT


def _join(bars: list[Float[np.ndarray, "8 3"]]) -> Mesh:
    """Closed bodies of bars as one mesh."""
    sides = [(k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4) for k in range(4)]
    quads = np.array([(3, 2, 1, 0), (4, 5, 6, 7), *sides])
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Mesh(
        vertices=np.concatenate(bars),
        faces=np.concatenate([faces + 8 * k for k in range(len(bars))]),
        uv=np.tile(np.array([[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3]]), (12 * len(bars), 1, 1)),
    )
