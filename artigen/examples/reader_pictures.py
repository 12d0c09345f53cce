"""Training pictures of the reader from rendered views: placed, dressed and photographed as people do.

A view may get other colours and textures, fronts cut out of marked photographs (whose pulls come with them),
a background, things before it, and all that cameras do. Backgrounds and textures are parts of marked
photographs where no front is.
"""

import cv2
import numpy as np
from jaxtyping import Bool, Float, UInt8, UInt16

from artigen.examples.photometry import smooth_noise, vary_photometry
from artigen.examples.picture_stock import BACKGROUND, CutOut, Stock
from artigen.examples.reader_views import NOTHING, View
from artigen.reader.labels import DIAL, FRONT, HINGES, OBJECT, PULL, THINGS, UNKNOWN
from artigen.reader.network import STRIDE
from artigen.reader.targets import MARK, Picture, make_mark

DRESSED, CUT_OUT = 0.45, 0.4
"""Shares of the views with other colours and textures, and of those with fronts of photographs."""
PHOTO_BEHIND, PLAIN_BEHIND = 0.45, 0.3
"""Shares of the backgrounds that are photographs, and that are one colour."""
CLUTTERED = 0.3
"""Share of the pictures with things before the object."""
LETTERBOXED = 0.25
"""Share of the pictures with bars at two sides."""
VISIBLE = 0.3
"""Share of a part that must be in view for it to be marked."""
LEAST_FRONT, LEAST_OTHER = 0.004, 6
"""Least visible pixels: of a front as a share of the object, and of other parts."""


def make_picture(view: View, stock: Stock, size: int, rng: np.random.Generator) -> Picture:
    """A training picture of ``size`` pixels."""
    alpha = view.rgba[..., 3:].astype(np.float32) / 255
    rgb = np.clip(view.rgba[..., :3].astype(np.float32) / 255 / np.maximum(alpha, 0.02), 0, 1)
    ids, parts = view.ids.copy(), view.parts.copy()
    pulls: list[Float[np.ndarray, "4 2"]] = []
    chance = rng.random()
    if chance < CUT_OUT and stock.sets:
        rgb, pulls = _paste_fronts(rgb, ids, parts, stock, rng)
    elif CUT_OUT < chance < CUT_OUT + DRESSED:
        rgb = _dress(rgb, ids, parts, stock, rng)
    matrix = _choose_homography(ids, view.rgba.shape[0], size, rng)
    drawn = cv2.warpPerspective(rgb * alpha, matrix, (size, size), flags=cv2.INTER_LINEAR)
    cover = cv2.warpPerspective(alpha, matrix, (size, size), flags=cv2.INTER_LINEAR)[..., None]
    placed = cv2.warpPerspective(ids, matrix, (size, size), flags=cv2.INTER_NEAREST, borderValue=NOTHING)
    behind = _make_background(stock, size, rng)
    if rng.random() < 0.5:
        behind = behind * (1 - rng.uniform(0.1, 0.7) * _cast_shadow(cover[..., 0], rng)[..., None])
    image = drawn + behind * (1 - cover)
    if rng.random() < CLUTTERED:
        _add_clutter(image, placed, stock, rng)
    pixels = vary_photometry((np.clip(image, 0, 1) * 255).astype(np.uint8), rng)
    if rng.random() < LETTERBOXED:
        _letterbox(pixels, placed, rng)
    scale = abs(float(np.linalg.det(matrix))) / max(abs(float(matrix[2, 2])) ** 3, 1e-9)
    marks, hidden = _find_marks(view, parts, ids, placed, matrix, scale)
    for corners in pulls:
        there = cv2.perspectiveTransform(corners[None].astype(np.float32), matrix)[0]
        box = np.concatenate([there.min(axis=0), there.max(axis=0)])
        seen = np.clip(box, 0, size)
        if np.prod(seen[2:] - seen[:2]) > 0.6 * np.prod(box[2:] - box[:2]) and max(seen[2:] - seen[:2]) > 3:
            x, y = ((seen[:2] + seen[2:]) / 2).astype(int)
            if placed[min(y, size - 1), min(x, size - 1)] != NOTHING:
                marks.append(make_mark(PULL, seen))
    weight = np.ones((len(THINGS), size // STRIDE, size // STRIDE), np.float32)
    for thing, box in hidden:
        low, high = np.floor(box[:2] / STRIDE).astype(int), np.ceil(box[2:] / STRIDE).astype(int)
        weight[thing, max(0, low[1]) : high[1], max(0, low[0]) : high[0]] = 0.0
    return Picture(pixels=pixels, marks=np.array(marks, MARK).reshape(-1), weight=weight)


def _find_marks(
    view: View,
    parts: np.ndarray,
    before: UInt16[np.ndarray, "S S"],
    placed: UInt16[np.ndarray, "s s"],
    matrix: Float[np.ndarray, "3 3"],
    scale: float,
) -> tuple[list[np.ndarray], list[tuple[int, np.ndarray]]]:
    """Marks of what is well in view; things and boxes of what is hardly so."""
    count = len(parts)
    whole = np.bincount(before.ravel(), minlength=NOTHING + 1)[:count] * scale
    seen = np.bincount(placed.ravel(), minlength=NOTHING + 1)[:count]
    boxes = _find_boxes(placed, count)
    main = seen[parts["object"] == 0].sum()
    marks, hidden = [], []
    for index in np.flatnonzero(seen):
        part, box = parts[index], boxes[index]
        thing = int(part["thing"])
        if thing == UNKNOWN:
            continue
        least = max(20.0, LEAST_FRONT * main) if thing == FRONT else LEAST_OTHER
        sides = box[2:] - box[:2]
        if seen[index] < least or seen[index] < VISIBLE * whole[index] or (thing == FRONT and min(sides) < 5):
            hidden.append((thing, box))
            continue
        mark = make_mark(thing, box, **{k: part[k] for k in ("door", "hinge", "open", "pane", "material")})
        if thing == FRONT:
            corners = cv2.perspectiveTransform(part["corners"][None], matrix)[0]
            hull = np.concatenate([corners.min(axis=0), corners.max(axis=0)])
            if np.abs(hull - box).max() < 0.08 * max(sides):
                mark["corners"] = corners
        marks.append(mark)
    for number, body in enumerate(view.bodies):
        own = np.flatnonzero(parts["object"] == number)
        here = own[seen[own] > 0]
        if not len(here):
            continue
        box = np.concatenate([boxes[here, :2].min(axis=0), boxes[here, 2:].max(axis=0)])
        if seen[here].sum() < 0.35 * whole[own].sum() or min(box[2:] - box[:2]) < 12:
            hidden.append((OBJECT, box))
            continue
        marks.append(
            make_mark(
                OBJECT, box, kind=body["kind"], stand=body["stand"], view=body["view"], size=body["size"]
            )
        )
    return marks, hidden


def _find_boxes(ids: UInt16[np.ndarray, "S S"], count: int) -> Float[np.ndarray, "P 4"]:
    """Boxes around the pixels of each part."""
    rows, columns = np.nonzero(ids < count)
    own = ids[rows, columns]
    out = np.tile(np.array([np.inf, np.inf, -np.inf, -np.inf], np.float32), (count, 1))
    np.minimum.at(out[:, 0], own, columns)
    np.minimum.at(out[:, 1], own, rows)
    np.maximum.at(out[:, 2], own, columns + 1)
    np.maximum.at(out[:, 3], own, rows + 1)
    return out


def _paste_fronts(
    rgb: Float[np.ndarray, "S S 3"],
    ids: UInt16[np.ndarray, "S S"],
    parts: np.ndarray,
    stock: Stock,
    rng: np.random.Generator,
) -> tuple[Float[np.ndarray, "S S 3"], list[np.ndarray]]:
    """Puts fronts of one photograph onto closed fronts, which lose their own pulls; returns corners of new
    pulls.

    ``ids`` and ``parts`` are changed in place.
    """
    size = len(rgb)
    cutouts = stock.sets[rng.integers(len(stock.sets))]
    pulls: list[np.ndarray] = []
    covered = np.zeros(ids.shape, bool)
    tint = np.exp(rng.normal(0, 0.12, 3)).astype(np.float32)
    for index in np.flatnonzero((parts["thing"] == FRONT) & (parts["open"] == 0) & (parts["pane"] == 0)):
        corners = parts["corners"][index]
        mask = ids == index
        if not mask.any() or np.ptp(corners, axis=0).min() < 8 or np.abs(corners).max() > 4 * size:
            continue
        door = bool(parts["door"][index])
        wide, high = np.linalg.norm(corners[1] - corners[0]), np.linalg.norm(corners[3] - corners[0])
        fits = [c for c in cutouts if c.door == door and 0.5 < _aspect(c) / (wide / max(high, 1e-3)) < 2.0]
        if not fits:
            continue
        cutout = fits[rng.integers(len(fits))]
        hinge, mirrored = int(parts["hinge"][index]), False
        sides = (HINGES.index("left"), HINGES.index("right"))
        if cutout.hinge in sides and hinge in sides:
            mirrored = cutout.hinge != hinge
        elif door:
            parts["hinge"][index] = (
                cutout.hinge
            )  # a hinge side that the pasted picture does not show is unknown
        h, w = cutout.pixels.shape[:2]
        source = np.array([[0, 0], [w, 0], [w, h], [0, h]], np.float32)
        if mirrored:
            source = source[[1, 0, 3, 2]]
        to_view = cv2.getPerspectiveTransform(source, corners.astype(np.float32))
        warped = cv2.warpPerspective(cutout.pixels, to_view, (size, size), flags=cv2.INTER_AREA)
        quad = np.zeros(ids.shape, np.uint8)
        cv2.fillConvexPoly(quad, corners.round().astype(np.int32), 1)
        inside = (quad > 0) & (mask | _on_front(ids, parts, int(index), quad > 0))
        shade = 0.35 + 0.65 * _shading(rgb, mask) if rng.random() < 0.5 else 1.0
        rgb[inside] = np.clip(warped[inside].astype(np.float32) / 255 * tint * shade, 0, 1)
        ids[inside] = index
        covered |= inside
        parts["material"][index] = UNKNOWN
        for pull in cutout.pulls:
            x0, y0, x1, y1 = pull * [w, h, w, h]
            box = np.array([[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]], np.float32)
            pulls.append(cv2.perspectiveTransform(box, to_view)[0])
    if covered.any() and rng.random() < 0.8:  # the body goes with its fronts
        body = (ids < len(parts)) & ~covered & np.isin(ids, np.flatnonzero(parts["thing"] == UNKNOWN))
        own = body & (parts["object"][np.minimum(ids, len(parts) - 1)] >= 0)
        if own.any():
            mean = rgb[covered].mean(axis=0) * np.exp(rng.normal(0, 0.15))
            grey = rgb[own].mean(axis=1, keepdims=True)
            rgb[own] = np.clip(mean * np.minimum(grey / max(float(np.percentile(grey, 80)), 0.05), 1.3), 0, 1)
    return rgb, pulls


def _on_front(
    ids: UInt16[np.ndarray, "S S"], parts: np.ndarray, front: int, quad: Bool[np.ndarray, "S S"]
) -> Bool[np.ndarray, "S S"]:
    """Pixels of handles and dials of the same object within a front."""
    pulls = np.flatnonzero(
        ((parts["thing"] == PULL) | (parts["thing"] == DIAL)) & (parts["object"] == parts["object"][front])
    )
    return quad & np.isin(ids, pulls)


def _aspect(cutout: CutOut) -> float:
    return cutout.pixels.shape[1] / cutout.pixels.shape[0]


def _shading(rgb: Float[np.ndarray, "S S 3"], mask: Bool[np.ndarray, "S S"]) -> float:
    """How bright a front is."""
    return float(min(1.0, rgb[mask].mean() / 0.7))


def _dress(
    rgb: Float[np.ndarray, "S S 3"],
    ids: UInt16[np.ndarray, "S S"],
    parts: np.ndarray,
    stock: Stock,
    rng: np.random.Generator,
) -> Float[np.ndarray, "S S 3"]:
    """Other colours or textures for bodies, fronts and pulls; keeps the shading. ``parts`` is changed in
    place."""
    look = np.append(np.where(parts["object"] >= 0, parts["thing"], THINGS.index("object")), OBJECT)
    of_pixel = look[np.minimum(ids, len(parts))]
    bodies = np.isin(of_pixel, (UNKNOWN, THINGS.index("shelf"), THINGS.index("wheel")))
    fronts, pulls = of_pixel == FRONT, np.isin(of_pixel, (PULL, DIAL))
    groups = [bodies, fronts, pulls]
    chance = rng.random()
    if chance < 0.4:
        groups = [bodies | fronts, pulls]
    elif chance < 0.5:
        groups = [bodies | fronts | pulls]
    size = len(rgb)
    for group in groups:
        if rng.random() < 0.4 or not group.any():
            continue
        grey = rgb[group].mean(axis=1, keepdims=True)
        shade = np.minimum(grey / max(float(np.percentile(grey, 80)), 0.05), 1.4)
        how = rng.random()
        if how < 0.45:
            texture = np.broadcast_to(_draw_color(rng), (int(group.sum()), 3))
        elif how < 0.7:
            texture = (_draw_color(rng) * _draw_grain(rng, size))[group]
        else:
            part = stock.backgrounds[rng.integers(len(stock.backgrounds))]
            side = int(rng.integers(40, BACKGROUND))
            x, y = rng.integers(0, BACKGROUND - side + 1, 2)
            texture = (
                cv2.resize(part[y : y + side, x : x + side], (size, size))[group].astype(np.float32) / 255
            )
            if rng.random() < 0.6:
                texture = texture.mean(axis=0) + (texture - texture.mean(axis=0)) * 0.4
        kept = rng.uniform(0.0, 0.3)
        rgb[group] = np.clip(kept * rgb[group] + (1 - kept) * texture * shade, 0, 1)
    parts["material"] = UNKNOWN
    return rgb


def _draw_color(rng: np.random.Generator) -> Float[np.ndarray, "3"]:
    """Mostly greyish, sometimes strong."""
    spread = rng.choice([0.02, 0.06, 0.2], p=[0.4, 0.4, 0.2])
    return np.clip(rng.uniform(0.05, 1.0) + rng.normal(0, spread, 3), 0, 1).astype(np.float32)


def _draw_grain(rng: np.random.Generator, size: int) -> Float[np.ndarray, "S S 1"]:
    """Streaks with mean one, across or along."""
    cells = rng.random((size // rng.integers(4, 40) + 2, size // rng.integers(1, 5) + 2), dtype=np.float32)
    streaks = cv2.resize(cells, (size, size), interpolation=cv2.INTER_LINEAR) - 0.5
    return 1 + rng.uniform(0.1, 0.6) * (streaks.T if rng.random() < 0.5 else streaks)[..., None]


def _choose_homography(
    ids: UInt16[np.ndarray, "S S"], edge: int, size: int, rng: np.random.Generator
) -> Float[np.ndarray, "3 3"]:
    """Map from a view to a picture: scale, place, stretch, roll, keystone, mirror; sometimes cut by the
    frame."""
    rows, columns = np.nonzero(ids < NOTHING)
    if len(rows) == 0 or len(rows) > 0.98 * ids.size:  # a room fills the view
        x0, y0, x1, y1 = 0.0, 0.0, float(edge), float(edge)
        zoom = rng.uniform(1.0, 1.35)
    else:
        x0, y0, x1, y1 = columns.min(), rows.min(), columns.max() + 1, rows.max() + 1
        zoom = rng.uniform(0.45, 1.05) if rng.random() < 0.75 else rng.uniform(1.0, 1.25)
    wide, high = x1 - x0, y1 - y0
    scale = size * zoom / max(wide, high)
    stretch = np.exp(rng.normal(0, 0.08))
    extent = np.array([wide * scale * stretch, high * scale / stretch])
    room = size - extent
    offset = room / 2 + rng.uniform(-0.5, 0.5, 2) * np.abs(room)
    source = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], np.float32)
    target = offset + extent * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    angle = np.deg2rad(rng.normal(0, 2.5))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    middle = target.mean(axis=0)
    target = (target - middle) @ turn.T + middle + rng.normal(0, 0.012, (4, 2)) * size
    return cv2.getPerspectiveTransform(source, target.astype(np.float32)).astype(np.float32)


def _make_background(stock: Stock, size: int, rng: np.random.Generator) -> Float[np.ndarray, "S S 3"]:
    chance = rng.random()
    if chance < PHOTO_BEHIND:
        part = stock.backgrounds[rng.integers(len(stock.backgrounds))]
        side = int(rng.integers(120, BACKGROUND + 1))
        x, y = rng.integers(0, BACKGROUND - side + 1, 2)
        image = cv2.resize(part[y : y + side, x : x + side], (size, size)).astype(np.float32) / 255
        return cv2.GaussianBlur(image, (0, 0), rng.uniform(1, 6)) if rng.random() < 0.3 else image
    if chance < PHOTO_BEHIND + PLAIN_BEHIND:
        white = np.full(3, rng.uniform(0.85, 1), np.float32)
        return np.broadcast_to(white if rng.random() < 0.6 else _draw_color(rng), (size, size, 3)).copy()
    wall = np.broadcast_to(_draw_color(rng), (size, size, 3)).copy()
    if rng.random() < 0.4:
        wall = wall * _draw_grain(rng, size)
    line = int(size * rng.uniform(0.5, 1.0))
    floor = _draw_color(rng) * (
        _draw_grain(rng, size) if rng.random() < 0.6 else np.ones((size, size, 1), np.float32)
    )
    wall[line:] = floor[line:]
    if rng.random() < 0.4:
        wall[max(0, line - int(rng.integers(2, 12))) : line] = _draw_color(rng)
    for _ in range(int(rng.integers(0, 6))):
        corner, extent = rng.integers(0, size, 2), rng.integers(8, size // 2, 2)
        color = tuple(_draw_color(rng).tolist())
        filled = -1 if rng.random() < 0.7 else int(rng.integers(1, 5))
        cv2.rectangle(wall, corner.tolist(), (corner + extent).tolist(), color, filled)
    return np.clip(wall + 0.3 * (smooth_noise(rng, size, 3) - 0.5), 0, 1).astype(np.float32)


def _cast_shadow(cover: Float[np.ndarray, "S S"], rng: np.random.Generator) -> Float[np.ndarray, "S S"]:
    size = len(cover)
    shift = np.array([[1, 0, rng.normal(0, 0.03) * size], [0, 1, rng.uniform(0, 0.04) * size]], np.float32)
    coarse = cv2.resize(cv2.warpAffine(cover, shift, (size, size)), (size // 4, size // 4))
    return cv2.resize(cv2.GaussianBlur(coarse, (0, 0), rng.uniform(0.7, 3.5)), (size, size))


def _add_clutter(
    image: Float[np.ndarray, "S S 3"], ids: UInt16[np.ndarray, "S S"], stock: Stock, rng: np.random.Generator
) -> None:
    """Patches of photographs before the object or on top of it; image and ids are changed in place."""
    size = len(image)
    for _ in range(int(rng.integers(1, 4))):
        high, wide = rng.integers(10, size // 4, 2)
        y, x = rng.integers(0, size - high), rng.integers(0, size - wide)
        rows = np.flatnonzero((ids < NOTHING).any(axis=1))
        if rng.random() < 0.6 and len(rows):
            y = int(np.clip(rows[0] - high * 0.8, 0, size - high))
        part = stock.backgrounds[rng.integers(len(stock.backgrounds))]
        v, u = rng.integers(0, BACKGROUND - max(high, wide), 2)
        patch = part[v : v + high, u : u + wide].astype(np.float32) / 255
        mask = np.zeros((high, wide), np.uint8)
        if rng.random() < 0.6:
            cv2.ellipse(
                mask, (int(wide // 2), int(high // 2)), (int(wide // 2), int(high // 2)), 0, 0, 360, 1, -1
            )
        else:
            mask.fill(1)
        image[y : y + high, x : x + wide] = np.where(
            mask[..., None] > 0, patch, image[y : y + high, x : x + wide]
        )
        ids[y : y + high, x : x + wide][mask > 0] = NOTHING


def _letterbox(
    pixels: UInt8[np.ndarray, "S S 3"], ids: UInt16[np.ndarray, "S S"], rng: np.random.Generator
) -> None:
    """Bars at two sides, as photographs get that are no squares; pixels and ids are changed in place."""
    size = len(pixels)
    bar = int(size * rng.uniform(0.02, 0.22))
    value = int(rng.choice([0, 128, 255], p=[0.1, 0.3, 0.6]))
    upright = rng.random() < 0.5
    for part in (slice(0, bar), slice(size - bar, size)):
        where = (slice(None), part) if upright else (part, slice(None))
        pixels[where] = value
        ids[where] = NOTHING
