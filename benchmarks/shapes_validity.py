"""Checks geometry laws of procedural objects exactly.

    python benchmarks/shapes_validity.py --count 1000 --out out/shapes_validity

draws objects of every category and judges each: parts are connected and stand on the floor, nothing overlaps
at rest or at 21 poses of any joint (others closed, or open as required), and every link is a valid collision
body. Distances are those of convex hulls (`sim_export.geometry.contacts`). Writes ``validity.md`` (table)
and ``failures.txt`` (category, seed, reason).
"""

import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import tyro
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from artigen.errors import ArtigenError
from artigen.kind import kinds
from artigen.kinematics import displacements, movable_parts
from artigen.shapes.asset import shape_parts
from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape
from artigen.types import Asset
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import hull_width
from sim_export.package import Hull
from sim_export.physics.links import link_owners

POSES = 21
TOUCH = 1e-3
"""Largest distance (m) between the primitives of a part, and between a part and one that it is fixed to."""
GAP = 4e-3
"""Largest distance (m) of a moving part from its carrier."""
OVERLAP = 1e-4
"""Depth (m) up to which overlaps are ignored."""
FLOOR = 1e-4
"""Largest distance (m) of the lowest points from the floor."""
THINNEST = 1.1e-3
"""Minimum thickness (m) of a primitive, for collision."""
AJAR = np.eye(4)
AJAR[:3, 3] = (3.1e-6, -2.3e-6, 1.7e-6)
"""Wedges of a ring share whole edges; a shift of a few micrometres keeps their distance well defined."""
MAX_HULLS = 32
MAX_HULLS_IN_ALL = 256


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    out: Path = Path("out/shapes_validity")
    """Folder for the table and the failures."""
    category: tuple[str, ...] = ()
    """Categories; all by default."""
    count: int = 1000
    """Objects per category."""
    first: int = 0
    """Seed of the first object."""
    workers: int = 2
    """Number of processes."""


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """Result for one object: one sentence per broken law."""

    category: str
    seed: int
    problems: tuple[tuple[str, str], ...]
    """Broken law and the parts that break it."""
    seconds: float
    labels: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()


class Scene:
    """A shape as hulls, one set per part, with the motion of the parts (metres)."""

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        parts = shape_parts(shape, np.zeros(3), 1.0)
        self.asset = Asset(name=shape.name, category=shape.category, scale=1.0, parts=parts)
        self.names = [part.name for part in parts]
        self.owners = np.array(link_owners(self.asset))
        self.hulls = [
            [Hull(vertices=place_vertices(primitive), faces=primitive.faces) for primitive in part.primitives]
            for part in shape.parts
        ]
        self.movable = movable_parts(self.asset)

    def moved_parts(self, leader: int) -> list[int]:
        """The part and its descendants."""
        inside = {leader}
        grown = True
        while grown:
            more = {k for k, part in enumerate(self.asset.parts) if part.parent in inside} - inside
            inside |= more
            grown = bool(more)
        return sorted(inside)

    def opened(self, part: int) -> dict[int, float]:
        """Coordinates of the parts that must be open before this one moves, their needs and followers."""
        found: dict[int, float] = {}
        waiting = [part]
        while waiting:
            for need in self.shape.parts[waiting.pop()].needs:
                other = self.names.index(need.part)
                upper = need.fraction * self.asset.parts[other].joint.upper
                if upper > found.get(other, 0.0):
                    found[other] = upper
                    waiting.append(other)
        uppers = [part.joint.upper for part in self.asset.parts]
        for index, led in enumerate(self.shape.parts):
            leader = None if led.joint is None else led.joint.follows
            if leader is not None and (at := self.names.index(leader)) in found:
                found[index] = found[at] / uppers[at] * uppers[index]
        return found

    def bodies(self, parts: list[int], T: np.ndarray | None = None) -> tuple[HullSet, np.ndarray]:
        """Hulls of some parts, displaced by ``T`` (one per part of the asset), and their owners."""
        hulls, owners = [], []
        for part in parts:
            for hull in self.hulls[part]:
                moved = hull
                if T is not None and not np.array_equal(T[part], np.eye(4)):
                    vertices = hull.vertices @ T[part, :3, :3].T + T[part, :3, 3]
                    moved = Hull(vertices=vertices, faces=hull.faces)
                hulls.append(moved)
                owners.append(part)
        return HullSet(hulls=tuple(hulls)), np.array(owners, dtype=np.int64)


def judge_shape(shape: Shape) -> Iterator[tuple[str, str]]:
    """Every broken law of a shape, with its cause."""
    scene = Scene(shape)
    yield from judge_floor(scene)
    yield from judge_bodies(scene)
    yield from judge_pieces(scene)
    yield from judge_carriers(scene)
    yield from judge_rest(scene)
    for part in scene.movable:
        yield from judge_sweep(scene, part)


def judge_floor(scene: Scene) -> Iterator[tuple[str, str]]:
    """The object stands on the floor with at least three points not in line."""
    points = np.concatenate([hull.vertices for hulls in scene.hulls for hull in hulls])
    lowest = float(points[:, 2].min())
    if abs(lowest) > FLOOR:
        yield "floor", f"the lowest point is at z = {1e3 * lowest:.2f} mm"
        return
    feet = points[points[:, 2] < FLOOR, :2]
    spread = np.linalg.svd(feet - feet.mean(axis=0), compute_uv=False) if len(feet) >= 3 else np.zeros(2)
    if spread[-1] < 1e-2:
        yield "floor", f"{len(feet)} points on the floor, spread over {1e3 * spread[-1]:.1f} mm only"


def judge_bodies(scene: Scene) -> Iterator[tuple[str, str]]:
    """Hulls are thick enough and few enough for simulators."""
    counts = Counter(int(scene.owners[part]) for part, hulls in enumerate(scene.hulls) for _ in hulls)
    for leader, count in sorted(counts.items()):
        if count > MAX_HULLS:
            yield "hulls", f"link of {scene.names[leader]} has {count} primitives, at most {MAX_HULLS}"
    if sum(counts.values()) > MAX_HULLS_IN_ALL:
        yield "hulls", f"{sum(counts.values())} primitives in all, at most {MAX_HULLS_IN_ALL}"
    for part, hulls in enumerate(scene.hulls):
        for index, hull in enumerate(hulls):
            width = hull_width(hull)[0]
            if width < THINNEST:
                yield "thin", f"{scene.names[part]}[{index}] is {1e3 * width:.2f} mm thick"


def judge_pieces(scene: Scene) -> Iterator[tuple[str, str]]:
    """All primitives of a part are connected."""
    for part in range(len(scene.hulls)):
        body, _ = scene.bodies([part])
        found = signed_distances(body, body, np.eye(4), AJAR, TOUCH)
        size = len(body.hulls)
        links = coo_matrix((np.ones(len(found.first)), (found.first, found.second)), shape=(size, size))
        count, group = connected_components(links, directed=False)
        if count > 1:
            loose = np.flatnonzero(group != np.bincount(group).argmax())
            yield "detached", f"{scene.names[part]} is in {count} pieces; {loose.tolist()} are loose"


def judge_carriers(scene: Scene) -> Iterator[tuple[str, str]]:
    """A fixed part touches its parent, a moving one is near the link that carries it."""
    for index, part in enumerate(scene.asset.parts):
        if part.parent == -1:
            continue
        fixed = part.joint.type == "fixed"
        owner = scene.owners[part.parent]
        parents = [part.parent] if fixed else np.flatnonzero(scene.owners == owner).tolist()
        own = [index] if fixed else np.flatnonzero(scene.owners == index).tolist()
        body, _ = scene.bodies(own)
        carrier, _ = scene.bodies(parents)
        reach = TOUCH if fixed else GAP
        if not len(signed_distances(body, carrier, np.eye(4), AJAR, reach).distance):
            yield "gap", f"{part.name} is more than {1e3 * reach:g} mm away from {scene.names[part.parent]}"


def judge_rest(scene: Scene) -> Iterator[tuple[str, str]]:
    """Nothing overlaps when everything is closed."""
    body, owners = scene.bodies(list(range(len(scene.hulls))))
    leaders = scene.owners[owners]
    low, high = np.moveaxis(body.bounds(np.eye(4)), 1, 0)
    meet = np.all((low[:, None] <= high[None]) & (high[:, None] >= low[None]), axis=-1)
    meet &= np.triu(leaders[:, None] != leaders[None])
    told = set()
    for first, second in np.argwhere(meet).tolist():
        pair = HullSet(hulls=(body.hulls[first],)), HullSet(hulls=(body.hulls[second],))
        found = signed_distances(*pair, np.eye(4), np.eye(4))
        names = scene.names[owners[first]], scene.names[owners[second]]
        if len(found.distance) and found.distance[0] < -OVERLAP and names not in told:
            told.add(names)
            yield (
                "rest",
                f"{names[0]}[{piece_number(owners, first)}] and {names[1]}[{piece_number(owners, second)}] "
                f"overlap by {-1e3 * found.distance[0]:.2f} mm at rest",
            )


def judge_sweep(scene: Scene, part: int) -> Iterator[tuple[str, str]]:
    """No joint is blocked between closed and open."""
    column = {other: k for k, other in enumerate(scene.movable)}
    qpos = np.zeros((POSES, len(scene.movable)))
    for other, q in scene.opened(part).items():
        qpos[:, column[other]] = q
    qpos[:, column[part]] = np.linspace(0.0, scene.asset.parts[part].joint.upper, POSES)
    T = displacements(scene.asset, qpos)
    moved = scene.moved_parts(part)
    still = [index for index in range(len(scene.hulls)) if index not in moved]
    others, other_owners = scene.bodies(still, T[0])
    for leader in sorted({int(scene.owners[index]) for index in moved}):
        body, owners = scene.bodies([index for index in moved if scene.owners[index] == leader])
        bounds = body.bounds(T[:, leader])
        low, high = bounds[..., 0, :].min(axis=(0, 1)), bounds[..., 1, :].max(axis=(0, 1))
        around = others.bounds(np.eye(4))
        near = np.flatnonzero(np.all((around[:, 0] <= high) & (around[:, 1] >= low), axis=1))
        close = HullSet(hulls=tuple(others.hulls[index] for index in near))
        found = signed_distances(body, close, T[:, leader], np.eye(4), -OVERLAP)
        if len(found.distance):
            worst = int(found.distance.argmin())
            first, second = int(found.first[worst]), int(near[found.second[worst]])
            mover = f"{scene.names[owners[first]]}[{piece_number(owners, first)}]"
            other = f"{scene.names[other_owners[second]]}[{piece_number(other_owners, second)}]"
            yield (
                "sweep",
                f"{scene.names[part]} opening: {mover} goes {-1e3 * found.distance[worst]:.2f} mm into "
                f"{other} at {found.pose[worst] / (POSES - 1):.2f} of its range",
            )


def piece_number(owners: np.ndarray, index: int) -> int:
    """Index of a hull's primitive in its part."""
    return index - int(np.searchsorted(owners, owners[index])) if (np.diff(owners) >= 0).all() else index


def judge_seed(category: str, seed: int) -> Verdict:
    """Draws one object and judges it."""
    start = time.process_time()
    try:
        shape = draw_shape(category, seed)
        problems = tuple(judge_shape(shape))
    except (ValueError, KeyError, IndexError, ArtigenError) as error:
        problem = ("drawing", f"{type(error).__name__}: {error}")
        return Verdict(category=category, seed=seed, problems=(problem,), seconds=time.process_time() - start)
    return Verdict(
        category=category,
        seed=seed,
        problems=problems,
        seconds=time.process_time() - start,
        labels=tuple(part.label for part in shape.parts),
        joints=tuple(part.joint.type for part in shape.parts if part.joint is not None),
    )


def write_results(verdicts: list[Verdict], out: Path) -> str:
    """Writes the table as Markdown, and the failures, one per line."""
    laws = sorted({law for verdict in verdicts for law, _ in verdict.problems})
    lines = ["| " + " | ".join(["category", "objects", "valid", *laws, "CPU s each"]) + " |"]
    lines.append("|---" * (len(laws) + 4) + "|")
    for category in sorted({verdict.category for verdict in verdicts}):
        own = [verdict for verdict in verdicts if verdict.category == category]
        broken = Counter(law for verdict in own for law in {law for law, _ in verdict.problems})
        valid = sum(not verdict.problems for verdict in own)
        seconds = np.mean([verdict.seconds for verdict in own])
        cells = [category, str(len(own)), str(valid), *(str(broken[law]) for law in laws), f"{seconds:.2f}"]
        lines.append("| " + " | ".join(cells) + " |")
    for title, field in (("labels", "labels"), ("joints", "joints")):
        held = Counter(word for verdict in verdicts for word in set(getattr(verdict, field)))
        share = ", ".join(f"{word} {held[word] / len(verdicts):.1%}" for word in sorted(held))
        lines += ["", f"Objects with {title}: {share}."]
    out.mkdir(parents=True, exist_ok=True)
    (out / "validity.md").write_text("\n".join(lines) + "\n")
    told = [f"{v.category} {v.seed}: {law}: {text}" for v in verdicts for law, text in v.problems]
    (out / "failures.txt").write_text("\n".join(told) + "\n")
    return "\n".join(lines)


def main(options: Options) -> int:
    """Judges all objects and writes the results."""
    names = options.category or tuple(kinds())
    seeds = range(options.first, options.first + options.count)
    verdicts: list[Verdict] = []
    with ProcessPoolExecutor(options.workers) as pool:
        for name in names:
            verdicts += pool.map(partial(judge_seed, name), seeds, chunksize=4)
            print(f"{name}: {len(seeds)} objects", file=sys.stderr, flush=True)
    print(write_results(verdicts, options.out))
    return 0 if all(not verdict.problems for verdict in verdicts) else 1


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
