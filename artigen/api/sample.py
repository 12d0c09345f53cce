"""Samples procedural objects from the grammar and exports them as validated packages."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

from artigen.api.batch import Finished, Laps, Made, Part, run_with_progress, take_part
from artigen.api.grids import GRIDS, make_on_grids
from artigen.api.names import choose_name
from artigen.errors import ArtigenError
from artigen.kind import plurals, spell_kind
from artigen.runtime.runner import Runner
from artigen.runtime.workers import Worker
from artigen.types import PartLabel

if TYPE_CHECKING:
    from artigen.api.generate import GenerateSettings
    from artigen.shapes.draw import Wish
    from artigen.shapes.families import Suite
    from artigen.shapes.shape import Shape
    from sim_export.package import SimPackage

TIMEOUT = 300.0
"""Time limit (seconds) for one stage of one object."""
SPACING = 1 / 192
"""Mean distance of the coloured surface samples for textures, relative to the longest edge."""


@dataclass(frozen=True, kw_only=True)
class ShapeSettings:
    """Properties of the objects and how they are exported; unset properties are sampled from the seed."""

    width: float | None = None
    """Width in metres, seen from the front."""
    depth: float | None = None
    """Depth in metres, including fronts; excluding handles where the category separates them."""
    height: float | None = None
    """Height in metres."""
    style: str | None = None
    """Style of the category, such as shaker; docs/reference/kinds.md lists them."""
    family: str | None = None
    """Look across kinds, such as shaker, slab or industrial: style, handles and materials."""
    suite: int | None = None
    """Choice of the family's materials and hardware; objects of one suite match. The object's seed if unset,
    or 0 with ``--like`` or ``--topology``."""
    counts: tuple[str, ...] = ()
    """Number of parts by label, such as drawer=3 door=0."""
    like: int | None = None
    """Seed of a template object: every object gets its links, joints and kinds of collision shapes, in other
    sizes and materials, so that one simulation batch can hold them all."""
    topology: tuple[str, ...] = ()
    """Number of parts by label, such as drawer=3 door=0: like ``--like``, with the first seed whose
    object has these counts as its template."""
    source: Literal["reference", "voxels"] = "reference"
    """``reference`` exports the exact primitives; ``voxels`` reconstructs the object from its 64^3 voxels,
    and from 96^3 and 128^3 voxels while its package fails validation."""
    detail: Literal["low", "high"] = "high"
    """``high``: visuals have smooth rounds and broken edges; ``low``: a third of the triangles (only with
    --source reference)."""
    visual_format: Literal["obj", "glb"] = "obj"
    """``glb`` adds one GLB per link and mobility_glb.urdf, which shows them."""
    splats: bool = False
    """Add 3D Gaussians to the package: discs on its surface, one PLY per link."""
    validation: Literal["full", "none"] = "full"
    """Run checks L0 to L3 on every package right after it is written."""


@dataclass(frozen=True, kw_only=True)
class ShapeJob:
    """Job to make the package of one procedural object."""

    category: str
    seed: int
    out: Path
    cfg: ShapeSettings = field(default_factory=ShapeSettings)
    name: str | None = None
    """Name of the package; default: category and seed."""
    grid: int = GRIDS[0]
    """Cells along the longest edge, with ``source`` voxels."""

    @property
    def key(self) -> str:
        """Name of the package."""
        return self.name or f"{self.category}_{self.seed}"

    @property
    def settings(self) -> str:
        """Object and settings as text."""
        return f"{self.key} {self.cfg}"


def choose_like(category: str, cfg: ShapeSettings) -> ShapeSettings:
    """Settings in which ``topology`` is replaced by ``like`` with the seed of the first matching object.

    Raises:
        ArtigenError: If ``like`` or ``counts`` are given, too, or no object has the parts.
    """
    if not cfg.topology:
        return cfg
    if cfg.like is not None or cfg.counts:
        raise ArtigenError(
            f"topology {' '.join(cfg.topology)} beside "
            + (f"like {cfg.like}" if cfg.like is not None else f"counts {' '.join(cfg.counts)}")
            + ": topology already selects the template object by its parts; omit the other option"
        )
    from artigen.shapes.draw import find_seed

    wish = read_suited_wish(ShapeJob(category=category, seed=0, out=Path(), cfg=cfg))
    seed = find_seed(category, read_counts(cfg.topology), wish)
    return replace(cfg, like=seed, topology=())


def draw_wished(job: ShapeJob) -> "Shape":
    """Draws the object of a job, in the finishes of its suite."""
    from artigen.shapes.draw import draw_shape
    from artigen.shapes.families import dress_shape

    wish, like, suite = read_suited_wish(job), job.cfg.like, read_suite(job)
    shape = draw_shape(job.category, job.seed, wish) if like is None else _draw_like(job, like, wish)
    return shape if suite is None else dress_shape(shape, suite)


def read_suite(job: ShapeJob) -> "Suite | None":
    """The suite of the object; None without a family.

    Raises:
        ArtigenError: If the family is unknown, or a suite is given without a family.
    """
    from artigen.shapes.families import FAMILIES, choose_suite

    if job.cfg.family is None:
        if job.cfg.suite is not None:
            raise ArtigenError(
                f"suite {job.cfg.suite} without a family: a suite is a choice of a family's materials and "
                f"hardware; families are {', '.join(FAMILIES)}"
            )
        return None
    own = job.seed if job.cfg.like is None and not job.cfg.topology else 0
    return choose_suite(job.cfg.family, own if job.cfg.suite is None else job.cfg.suite)


def read_suited_wish(job: ShapeJob) -> "Wish":
    """The wish of a job, with the style and hardware of its suite."""
    from artigen.shapes.families import wish_suite

    wish, suite = read_wish(job.cfg), read_suite(job)
    return wish if suite is None else wish_suite(job.category, suite, wish)


def _draw_like(job: ShapeJob, like: int, wish: "Wish") -> "Shape":
    """An object with the topology of that of seed ``like``."""
    from artigen.shapes.draw import draw_variant

    if job.cfg.source != "reference":
        raise ArtigenError(
            f"like {like} with source {job.cfg.source}: reconstruction from voxels changes the collision "
            "shapes; use source reference"
        )
    from sim_export.reference import describe_build

    build = _build_of(job.category, like, wish)
    return draw_variant(job.category, like, job.seed, lambda shape: describe_build(shape) == build, wish)


@cache
def _build_of(category: str, seed: int, wish: "Wish") -> list[object]:
    """Topology of the object of a seed; drawn once per process."""
    from artigen.shapes.draw import draw_shape
    from sim_export.reference import describe_build

    return describe_build(draw_shape(category, seed, wish))


def read_wish(cfg: "ShapeSettings | GenerateSettings") -> "Wish":
    """The wish in the settings, with parsed counts.

    Raises:
        ArtigenError: If a count is not of the form label=number.
    """
    from artigen.shapes.draw import Wish

    return Wish(
        width=cfg.width,
        depth=cfg.depth,
        height=cfg.height,
        style=cfg.style,
        counts=read_counts(cfg.counts),
    )


def read_counts(texts: Sequence[str]) -> tuple[tuple[PartLabel, int], ...]:
    """Parses counts of parts written as ``label=number``, the label in singular or plural; sorted by label.

    Raises:
        ArtigenError: If a text is not of that form, or two texts contradict each other.
    """
    labels: dict[str, PartLabel] = {label: label for label in get_args(PartLabel)}
    many = {plurals(label)[label]: label for label in labels}
    counts: dict[PartLabel, int] = {}
    for text in texts:
        said, _, number = text.partition("=")
        label = many.get(said, said)
        if label not in labels or not number.isdecimal():
            raise ArtigenError(
                f"count {text!r} is not of the form label=number; labels are {', '.join(labels)}"
            )
        if counts.setdefault(labels[label], int(number)) != int(number):
            raise ArtigenError(f"counts {label}={counts[labels[label]]} and {text} contradict each other")
    return tuple(sorted(counts.items()))


def build_sampled(job: ShapeJob, drawn: "Shape | None" = None) -> "SimPackage":
    """The package of a job; ``drawn`` is its object if that has been drawn already."""
    made = make_package(
        drawn or draw_wished(job),
        job.cfg.source,
        splats=job.cfg.splats,
        detail=job.cfg.detail,
        grid=job.grid,
    )
    suite = read_suite(job)
    suited = {} if suite is None else {"family": suite.family, "suite": str(suite.seed)}
    provenance = tuple(sorted((*made.provenance, *suited.items())))
    return replace(
        made,
        name=job.name or made.name,
        provenance=provenance,
        visual_format=job.cfg.visual_format,
    )


def export_shape(job: ShapeJob) -> Made:
    """Draws one object, exports it and writes the package; runs in a worker process."""
    from sim_export.files.write import write_package

    laps = Laps()
    drawn = draw_wished(job)
    laps.end("draw")
    package = build_sampled(job, drawn)
    laps.end("export")
    write_package(package, job.out / job.key, "replace")
    laps.end("write")
    return laps.made(package.records)


def make_package(
    drawn: "Shape",
    source: Literal["reference", "voxels"],
    *,
    splats: bool = False,
    detail: Literal["low", "high"] = "high",
    grid: int = GRIDS[0],
) -> "SimPackage":
    """The package of an object: exact, or reconstructed from ``grid`` voxels along its longest edge."""
    from artigen import __version__

    provenance = {
        "generator": f"artigen {__version__} shape",
        "source": f"procedural {drawn.category}, seed {drawn.seed}, style {drawn.style}",
        "made_from": source,
        "seed": str(drawn.seed),
        "style": drawn.style,
    }
    if source == "reference":
        from sim_export.reference import ReferenceConfig, build_reference

        cfg = ReferenceConfig(detail=detail, gaussians=splats)
        return build_reference(drawn, cfg, provenance=provenance)
    from artigen.api.convert import rebuild_from_voxels
    from artigen.shapes.asset import frame_shape, shape_to_asset
    from sim_export.appearance.splats import splat_package
    from sim_export.export import export_asset

    spacing = SPACING * frame_shape(drawn)[1]
    asset = rebuild_from_voxels(shape_to_asset(drawn, resolution=grid, spacing=spacing))
    package = export_asset(asset, provenance=provenance | {"grid": str(grid)}).package
    return splat_package(package, asset) if splats else package


def export_and_validate(worker: Worker, job: ShapeJob) -> Finished:
    """Makes and validates one object in a supervised process; from voxels, on finer grids while it fails."""
    jobs = [replace(job, grid=grid) for grid in (GRIDS if job.cfg.source == "voxels" else GRIDS[:1])]
    full = job.cfg.validation == "full"
    return make_on_grids(worker, jobs, export_shape, timeout=TIMEOUT, validation=full)


def export_only(worker: Worker, job: ShapeJob) -> Finished:
    """Makes one object in a supervised process, without checks."""
    return make_on_grids(worker, [job], export_shape, timeout=TIMEOUT, validation=False)


def sample_packages(
    category: str,
    out: Path,
    seeds: Sequence[int],
    cfg: ShapeSettings | None = None,
    *,
    runner: Runner,
    name: str | None = None,
    sheet: Path | None = None,
    part: Part | None = None,
) -> list[Finished]:
    """Samples objects into a folder of packages with a journal; finished ones are kept.

    Args:
        category: What to sample, such as StorageFurniture.
        out: Folder of the packages and the journal.
        seeds: Seed of every object.
        cfg: Properties of the objects and how they are exported.
        runner: Where objects are made.
        name: Name of the package, followed by the seed if there are several; default: category and seed.
        sheet: PNG to write: all objects closed in the top row, open in the bottom row.
        part: Part of the objects to make; None for all.

    Raises:
        ArtigenError: If an object cannot be drawn as wished, before any work starts.
    """
    jobs = list_shapes(category, out, seeds, cfg or ShapeSettings(), name)
    pictured = take_part(jobs, part) if sheet else jobs[:1]
    drawn = [draw_wished(job) for job in pictured]  # fails before any work starts
    results = run_with_progress(export_and_validate, jobs, out, runner=runner, part=part)
    if sheet is not None:
        write_sheet(drawn, sheet)
    return results


def list_shapes(
    category: str, out: Path, seeds: Sequence[int], cfg: ShapeSettings, name: str | None = None
) -> list[ShapeJob]:
    """One job for every seed; a topology becomes the seed of its template.

    Raises:
        ArtigenError: If there is no seed or one below 0, or the settings contradict each other.
    """
    if not seeds or min(seeds) < 0:
        raise ArtigenError(
            f"{len(seeds)} objects from seed {min(seeds, default=0)}: expected at least 1 object and a seed "
            "from 0"
        )
    category = spell_kind(category)
    cfg = choose_like(category, cfg)
    return [
        ShapeJob(category=category, seed=seed, out=out, cfg=cfg, name=choose_name(name, seed, len(seeds)))
        for seed in seeds
    ]


def write_sheet(drawn: "list[Shape]", path: Path) -> None:
    """Writes a PNG with all objects closed in the top row and open in the bottom row."""
    import numpy as np
    from PIL import Image

    from artigen.shapes.sheet import draw_sheet

    rows = [draw_sheet(drawn, opened) for opened in (0.0, 0.8)]
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(np.concatenate(rows, axis=0)).save(path)
