"""Rooms of the reader's views: objects in a row along a wall, a floor, walls and loose things."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Int

from artigen.shapes.primitives import Primitive, box, cylinder, move
from artigen.shapes.shape import Need, Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish, FinishKind

SURROUNDINGS = -1
"""Object of parts that belong to none: walls, floors and loose things."""


def arrange_shapes(shapes: Sequence[Shape], rng: np.random.Generator) -> list[Shape]:
    """Objects in a row along a wall, the first where it was."""
    gap = rng.choice([0.0, 0.003, 0.02, 0.2], p=[0.25, 0.25, 0.25, 0.25])
    low, high = shapes[0].bounds()
    left, right, out = high[1], low[1], [shapes[0]]
    for shape in shapes[1:]:
        first, last = shape.bounds()
        if rng.random() < 0.5:
            y, left = left + gap - first[1], left + gap + last[1] - first[1]
        else:
            y, right = right - gap - last[1], right - gap - (last[1] - first[1])
        out.append(_shift(shape, (float(high[0] - last[0]), float(y), 0.0)))
    return out


def _shift(shape: Shape, offset: tuple[float, float, float]) -> Shape:
    """The shape elsewhere."""
    return replace(
        shape,
        parts=tuple(
            replace(
                part,
                primitives=tuple(move(solid, offset) for solid in part.primitives),
                joint=None if part.joint is None else replace(part.joint, origin=part.joint.origin + offset),
            )
            for part in shape.parts
        ),
    )


def join_shapes(shapes: Sequence[Shape]) -> tuple[Shape, Int[np.ndarray, "P"]]:
    """One shape of several, and which of them each part comes from."""
    parts: list[ShapePart] = [
        ShapePart("world", "base", [box((0, 0, -9.0), (0.01, 0.01, -8.99), "0.none")], parent=None)
    ]
    finishes: list[tuple[str, Finish]] = [
        ("0.none", Finish(kind="lacquer", color=(0.5, 0.5, 0.5), accent=(0.5, 0.5, 0.5)))
    ]
    owners = [SURROUNDINGS]
    for index, shape in enumerate(shapes):
        own = f"{index}."
        finishes += [(own + name, finish) for name, finish in shape.finishes]
        for part in shape.parts:
            solids = tuple(
                replace(
                    solid,
                    finish=own + solid.finish,
                    lining=None if solid.lining is None else own + solid.lining,
                )
                for solid in part.primitives
            )
            motion = part.joint
            if motion is not None and motion.follows is not None:
                motion = replace(motion, follows=own + motion.follows)
            parts.append(
                replace(
                    part,
                    name=own + part.name,
                    primitives=solids,
                    joint=motion,
                    parent="world" if part.parent is None else own + part.parent,
                    needs=tuple(Need(part=own + need.part, fraction=need.fraction) for need in part.needs),
                )
            )
            owners.append(index)
    joined = Shape(category="Room", seed=0, style="room", parts=tuple(parts), finishes=tuple(finishes))
    return joined, np.array(owners)


def furnish_room(
    shapes: Sequence[Shape], rng: np.random.Generator
) -> tuple[list[ShapePart], list[tuple[str, Finish]]]:
    """A floor, walls and loose things as parts that belong to no object."""
    bounds = np.stack([shape.bounds() for shape in shapes])
    low, high = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
    finishes: list[tuple[str, Finish]] = []

    def finish(kinds: Sequence[FinishKind], light: tuple[float, float]) -> str:
        value = rng.uniform(*light)
        color = np.clip(value + rng.normal(0, rng.choice([0.02, 0.08, 0.2], p=[0.5, 0.35, 0.15]), 3), 0.02, 1)
        finishes.append(
            (
                f"room.{len(finishes)}",
                Finish(
                    kind=kinds[int(rng.integers(len(kinds)))],
                    color=tuple(color.tolist()),
                    accent=tuple(np.clip(color * rng.uniform(0.5, 1.1), 0, 1).tolist()),
                    grain=(0.0, 1.0, 0.0) if rng.random() < 0.5 else (1.0, 0.0, 0.0),
                    period=float(np.exp(rng.uniform(np.log(0.01), np.log(0.4)))),
                    seed=int(rng.integers(2**30)),
                    gloss=float(rng.uniform(0.0, 0.3)),
                ),
            )
        )
        return finishes[-1][0]

    floor = float(low[2])
    wall = high[0] + rng.choice([0.0, 0.01, rng.uniform(0.0, 1.5)], p=[0.4, 0.3, 0.3])
    solids: list[Primitive] = [
        box(
            (low[0] - 8, low[1] - 8, floor - 0.06),
            (wall + 0.1, high[1] + 8, floor - 0.001),
            finish(["wood", "stone", "lacquer"], (0.2, 0.9)),
        ),
        box(
            (wall, low[1] - 8, floor - 0.1),
            (wall + 0.1, high[1] + 8, floor + 4.5),
            finish(["lacquer", "lacquer", "stone", "wood"], (0.3, 1.0)),
        ),
    ]
    if rng.random() < 0.5:
        solids.append(
            box(
                (wall - 0.015, low[1] - 8, floor),
                (wall, high[1] + 8, floor + rng.uniform(0.05, 0.14)),
                finish(["lacquer", "wood"], (0.3, 1.0)),
            )
        )
    if rng.random() < 0.35:
        side = (
            high[1] + rng.uniform(0.01, 0.8) if rng.random() < 0.5 else low[1] - rng.uniform(0.01, 0.8) - 0.1
        )
        solids.append(
            box(
                (low[0] - 8, side, floor - 0.1),
                (wall, side + 0.1, floor + 4.5),
                finish(["lacquer", "stone"], (0.3, 1.0)),
            )
        )
    tops = [(float(b[0, 0]), float(b[1, 0]), float(b[0, 1]), float(b[1, 1]), float(b[1, 2])) for b in bounds]
    for _ in range(int(rng.integers(0, 6))):
        x0, x1, y0, y1, top = tops[rng.integers(len(tops))]
        size = np.exp(rng.uniform(np.log(0.05), np.log(0.4), 3))
        if rng.random() < 0.7:
            x, y, z = rng.uniform(x0, x1), rng.uniform(y0, y1), top
        else:
            x, y, z = x0 - rng.uniform(0.1, 1.2), rng.uniform(y0 - 0.5, y1 + 0.5), floor
        look = finish(["lacquer", "plastic", "wood", "steel"], (0.05, 1.0))
        if rng.random() < 0.5:
            solids.append(cylinder((x, y, z), (x, y, z + size[2]), size[0] / 2, look))
        else:
            solids.append(
                box(
                    (x - size[0] / 2, y - size[1] / 2, z),
                    (x + size[0] / 2, y + size[1] / 2, z + size[2]),
                    look,
                )
            )
    if rng.random() < 0.3:  # a picture or a window on the wall
        y, z = rng.uniform(low[1] - 0.5, high[1] + 0.5), floor + rng.uniform(1.2, 2.2)
        solids.append(
            box(
                (wall - 0.02, y, z),
                (wall, y + rng.uniform(0.2, 1.0), z + rng.uniform(0.2, 1.0)),
                finish(["lacquer", "plastic"], (0.0, 1.0)),
            )
        )
    return [
        ShapePart(f"room.{k}", "base", [solid], parent="world") for k, solid in enumerate(solids)
    ], finishes
