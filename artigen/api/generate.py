"""Category, words or a photo to validated packages; failures are redrawn."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from artigen.api.batch import Finished, Laps, Made, Part, make_and_validate, run_with_progress
from artigen.api.models import hash_file, hash_weights, load_drawer, load_sketch, load_structure
from artigen.api.names import choose_name, name_request
from artigen.api.sample import read_wish
from artigen.errors import ArtigenError
from artigen.kind import spell_kind
from artigen.runtime.runner import Runner
from artigen.runtime.workers import Worker
from artigen.weights import SHIPPED

if TYPE_CHECKING:
    from artigen.appearance.draw import AppearanceModel
    from artigen.appearance.paint import PaintedSurface
    from artigen.shapes.shape import Shape
    from artigen.sketch.asked import Asked
    from artigen.sketch.model import Drawn
    from artigen.sketch.understand import Request, Understood
    from artigen.types import Asset, PartLabel
    from sim_export.package import SimPackage

TIMEOUT = 300.0
"""Time limit in seconds for drawing and exporting one object."""


@dataclass(frozen=True, kw_only=True)
class GenerateSettings:
    """The condition and the sampling settings; unset properties are sampled."""

    text: str | None = None
    """A description in English, such as "a tall cabinet with three drawers and two doors"."""
    image: Path | None = None
    """Photo of one object, taken from near its front. It is read as by ``artigen read`` and built with its
    fronts where they are; words and numbers overrule what was read. A cut-out with transparency is read by
    the sketch network alone."""
    box: tuple[float, float, float, float] | None = None
    """Left, top, right and bottom of the object in the photo, as shares of width and height; default: the
    largest object."""
    reading: Path | None = None
    """File that ``artigen read --json`` wrote, edited or not: it is built instead of reading the photo, which
    is then only shown beside the object."""
    kind: str | None = None
    """Kind of the object, as the category."""
    doors: int | None = None
    """Number of doors, as ``--counts door=2``."""
    drawers: int | None = None
    """Number of drawers, as ``--counts drawer=3``."""
    width: float | None = None
    """Width in metres, seen from the front."""
    depth: float | None = None
    """Depth in metres, including handles."""
    height: float | None = None
    """Height in metres."""
    style: str | None = None
    """Style of the category, such as shaker or steel; docs/reference/kinds.md lists them."""
    counts: tuple[str, ...] = ()
    """Number of parts by label, such as drawer=3 door=0."""
    structure: Literal["sketch", "latent"] = "sketch"
    """``sketch`` exports the exact primitives of the sketch network; ``latent`` samples 64^3 voxels from
    the paper's latents within the boxes of the sketch and exports those in its colours."""
    temperature: float = 0.6
    """Sampling temperature of the sketch network; 1 matches the training data, lower is less varied. With a
    picture, parts are first tried at 0.1."""
    redraws: int = 3
    """Maximum number of new draws for an object with a known fault or that fails a check."""
    steps: int = 6
    """Sampler steps; only with --structure latent."""
    strength: float = 0.0
    """Guidance strength, 0 for none (the paper uses 3); only with --structure latent."""
    encoders: Path | None = None
    """Folder with the public weights of DINOv2 and CLIP, for latent models that were trained with them."""
    detail: Literal["low", "high"] = "high"
    """``high``: visuals have smooth rounds and broken edges; ``low``: a third of the triangles (only with
    --structure sketch)."""
    visual_format: Literal["obj", "glb"] = "obj"
    """``glb`` adds one GLB per link and mobility_glb.urdf, which shows them."""
    gaussians: bool = True
    """Add 3D Gaussians to the package, one PLY per link."""
    compare: bool = True
    """With a photo, write NAME.html beside the package: the photo and the object from the same place, with a
    slider between them."""


@dataclass(frozen=True, kw_only=True)
class GenerateJob:
    """Generation of one object; ``draws`` records why earlier draws were rejected."""

    model: Path
    category: str | None
    seed: int
    out: Path
    cfg: GenerateSettings = field(default_factory=GenerateSettings)
    draws: tuple[str, ...] = ()
    name: str | None = None
    """Name of the package; by default made of category, words and seed."""

    @property
    def key(self) -> str:
        """Name of the package."""
        return self.name or name_request(
            self.category, self.cfg.text, self.cfg.image or self.cfg.reading, self.seed
        )

    @property
    def settings(self) -> str:
        """Object, weights, picture and settings as text; where one of them changes, it is made again."""
        given = [path for path in (self.cfg.image, self.cfg.reading) if path is not None]
        return " ".join([self.key, hash_weights(self.model), *map(hash_file, given), str(self.cfg)])


def _understand(job: GenerateJob) -> "Understood":
    """Parses the request of a job in the vocabulary of its model."""
    from artigen.sketch.request import list_learned
    from artigen.sketch.understand import understand

    return understand(read_job(job), list_learned(job.model))


def read_job(job: GenerateJob) -> "Request":
    """The request of a job."""
    from artigen.sketch.understand import Request

    cfg = job.cfg
    counts: list[tuple[PartLabel, int | None]] = [("door", cfg.doors), ("drawer", cfg.drawers)]
    wish = read_wish(cfg)
    for label, count in counts:
        held = dict(wish.counts)
        if count is not None:
            if held.get(label, count) != count:
                raise ArtigenError(
                    f"{count} parts called {label}, and --counts says {held[label]}; give one number"
                )
            wish = replace(wish, counts=tuple(sorted((held | {label: count}).items())))
    if None not in (job.category, cfg.kind) and job.category != cfg.kind:
        raise ArtigenError(f"category {job.category} and --kind {cfg.kind}: name one")
    return Request(
        category=job.category or cfg.kind,
        text=cfg.text,
        image=cfg.image,
        box=cfg.box,
        reading=cfg.reading,
        wish=wish,
    )


def _ask(job: GenerateJob) -> "Asked":
    """Everything that a job asks for."""
    from artigen.sketch.asked import ask
    from artigen.sketch.request import list_learned

    return ask(read_job(job), lambda: load_sketch(job.model), job.seed, list_learned(job.model))


def check_job(job: GenerateJob) -> None:
    """Checks a job: reads its words and its picture, and loads its model where that draws.

    Raises:
        ArtigenError: If the model or the picture cannot be read, or the request cannot be met.
    """
    if _ask(job).reading is None:
        load_sketch(job.model)


def draw_generated(job: GenerateJob) -> "tuple[Drawn, Asked]":
    """Draws the object of a job, and what it was asked for."""
    from artigen.sketch.asked import draw_asked

    asked = _ask(job)
    noise = int(np.random.SeedSequence([job.seed, len(job.draws)]).generate_state(1)[0])
    return draw_asked(asked, noise, lambda: load_sketch(job.model), job.cfg.temperature), asked


def generate_object(job: GenerateJob) -> Made:
    """Draws one object, exports it and writes its package; runs in a worker process.

    Raises:
        ArtigenError: If the object has faults and may be drawn again.
    """
    from artigen import __version__
    from sim_export.files.write import write_package

    laps = Laps()
    drawn, asked = draw_generated(job)
    faults = tuple(f"sketch: {fault.text}" for fault in drawn.faults)
    if faults and len(job.draws) < job.cfg.redraws:
        raise ArtigenError("; ".join(faults))
    shape = drawn.shape
    laps.end("draw")
    condition = shape.condition
    provenance = {
        "generator": f"artigen {__version__} generate",
        "model": hash_weights(job.model),
        "structure": job.cfg.structure,
        "condition": json.dumps(
            {
                "category": condition.category,
                "counts": dict(condition.counts),
                "size": (condition.depth, condition.width, condition.height),
                "text": job.cfg.text,
                "image": None if job.cfg.image is None else job.cfg.image.name,
            }
        ),
        "seed": str(job.seed),
        "style": shape.style,
        "draws": json.dumps([*job.draws, "this one"]),
    }
    notes = (*asked.notes, *drawn.notes, *faults)
    make = _make_exact if job.cfg.structure == "sketch" else _make_latent
    package = make(job, shape, provenance, notes)
    package = replace(package, name=job.key, visual_format=job.cfg.visual_format)
    laps.end("export")
    write_package(package, job.out / job.key, "replace")
    laps.end("write")
    if job.cfg.compare and job.cfg.image is not None and asked.reading is not None:
        from artigen.conditioning.image import open_picture
        from artigen.reader.comparison import write_comparison

        page = job.out / f"{job.key}.html"
        write_comparison(page, open_picture(job.cfg.image), asked.reading, shape, notes)
        laps.end("compare")
    return laps.made(package.records)


def _make_exact(
    job: GenerateJob, shape: "Shape", provenance: dict[str, str], notes: tuple[str, ...]
) -> "SimPackage":
    """Package of the sketch's own primitives."""
    from sim_export.reference import ReferenceConfig, build_reference

    cfg = ReferenceConfig(detail=job.cfg.detail, gaussians=job.cfg.gaussians)
    package = build_reference(shape, cfg, provenance=provenance)
    return replace(package, records=(*notes, *package.records))


def _make_latent(
    job: GenerateJob, shape: "Shape", provenance: dict[str, str], notes: tuple[str, ...]
) -> "SimPackage":
    """Package of voxels that the paper's latents generate within the boxes of the sketch.

    Their meshes are painted like the sketch's surface, part by part. The paint colours the textures and
    conditions the sparse flow.

    Raises:
        ArtigenError: If the parts differ from those of the sketch, or its surface has no sample of a part.
    """
    from artigen.api.sample import SPACING
    from artigen.appearance.paint import paint_surface, repaint
    from artigen.conditioning.image import read_picture
    from artigen.latent.draw import GenerateConfig, generate_structure
    from artigen.models.conditions import StructureCondition
    from artigen.models.rectified_flow import SamplerConfig
    from artigen.shapes.asset import shape_to_asset
    from sim_export.export import export_asset
    from sim_export.geometry.surface import sample_surface

    model, image = load_structure(job.model, job.cfg.encoders), None
    known = model.preset.conditions
    if job.cfg.image is not None and known.image_size:
        image = read_picture(job.cfg.image, known.image_size, margin=known.image_margin).rgba
    noise = int(np.random.SeedSequence([job.seed, len(job.draws), 1]).generate_state(1)[0])
    told = shape_to_asset(shape, model.preset.resolution)
    painted = paint_surface(shape, told, SPACING)
    asked = StructureCondition(text=job.cfg.text, image=image)
    cfg = GenerateConfig(sampler=SamplerConfig(steps=job.cfg.steps, strength=job.cfg.strength))
    asset = generate_structure(model, asked, noise, cfg, boxes=told)
    names, known_names = ([part.name for part in one.parts] for one in (asset, told))
    if names != known_names:
        raise ArtigenError(
            f"{job.key}: the latent shows the parts {', '.join(names)}, expected those of the sketch, "
            f"{', '.join(known_names)}, whose colours they take; use a model that draws within outlines"
        )
    surface = repaint(sample_surface(asset), painted, names)
    colored = replace(asset, name=job.key, surface=surface.samples, notes=(*notes, *asset.notes))
    package = export_asset(colored, provenance=provenance).package
    drawer = load_drawer(job.model) if job.cfg.gaussians else None
    return package if drawer is None else _attach_drawn(package, drawer, colored, shape, surface, noise)


def _attach_drawn(
    package: "SimPackage",
    drawer: "AppearanceModel",
    asset: "Asset",
    shape: "Shape",
    surface: "PaintedSurface",
    seed: int,
) -> "SimPackage":
    """Adds Gaussians that the sparse flow generates on the painted surface of an asset's meshes."""
    from artigen.appearance.draw import generate_appearance
    from artigen.models.conditions import describe_shape
    from sim_export.appearance.splats import attach_splats

    shown = generate_appearance(drawer, asset, describe_shape(shape), seed, surface=surface)
    assert shown.gaussians is not None
    said = f"{len(shown.gaussians.means)} Gaussians are drawn on the meshes in the paint of the sketch"
    records = (*package.records, *shown.notes[len(asset.notes) :], said)
    return replace(package, links=attach_splats(package.links, shown), records=records)


def generate_and_validate(worker: Worker, job: GenerateJob, *, validation: bool = True) -> Finished:
    """Draws an object until it passes every check, with at most ``redraws`` new draws.

    If all draws fail, the last package is kept with its report. The provenance lists every draw. Where time
    or memory ran out, nothing is drawn instead: a seed gives the same object on any machine.
    """
    finished = make_and_validate(worker, job, generate_object, timeout=TIMEOUT, validation=validation)
    while not (finished.good or finished.stopped) and len(job.draws) < job.cfg.redraws:
        reason = finished.error or "; ".join(finished.failures)
        job = replace(job, draws=(*job.draws, reason))
        finished = make_and_validate(worker, job, generate_object, timeout=TIMEOUT, validation=validation)
    return replace(finished, notes=(*finished.notes, f"{len(job.draws) + 1} draws"))


def generate_packages(
    jobs: "Sequence[GenerateJob]", out: Path, *, runner: Runner, worker: Worker, part: Part | None = None
) -> list[Finished]:
    """Generates objects into a folder of packages with a journal; finished ones are kept.

    Args:
        jobs: See `list_jobs`.
        out: Folder of the packages and the journal.
        runner: Where objects are made.
        worker: Checks the first job, and is then the runner's first worker if that can use it; it is closed.
        part: Part of the objects to make; None for all.

    Raises:
        ArtigenError: If the model or the picture cannot be read, or the request cannot be met.
    """
    try:
        checked = worker.call(check_job, jobs[0], TIMEOUT)
        if checked.error is not None:
            raise ArtigenError(checked.error)
        runs = runner.begin_with(worker)
        return run_with_progress(generate_and_validate, jobs, out, runner=runs, part=part)
    finally:
        worker.close()


def list_jobs(
    out: Path,
    seeds: Sequence[int],
    cfg: GenerateSettings,
    *,
    category: str | None = None,
    model: Path = SHIPPED,
    name: str | None = None,
) -> list[GenerateJob]:
    """One job for every seed.

    Raises:
        ArtigenError: If a number is out of its range, or settings contradict each other.
    """
    if not seeds or min(seeds) < 0 or cfg.redraws < 0:
        raise ArtigenError(
            f"{len(seeds)} objects from seed {min(seeds, default=0)} with {cfg.redraws} redraws: expected at "
            "least one object, and nothing below 0"
        )
    if cfg.steps < 1 or not 0 <= cfg.strength < math.inf or not 0 < cfg.temperature < math.inf:
        raise ArtigenError(
            f"{cfg.steps} steps, strength {cfg.strength:g}, temperature {cfg.temperature:g}: expected at "
            "least one step, no strength below 0, and a temperature above 0"
        )
    return [
        GenerateJob(
            model=model,
            category=category and spell_kind(category),
            seed=seed,
            out=out,
            cfg=cfg,
            name=choose_name(name, seed, len(seeds)),
        )
        for seed in seeds
    ]


def understand_job(job: GenerateJob) -> "Understood":
    """What is understood of the request of a job, without its model or its picture.

    Raises:
        ArtigenError: If its sentence or its numbers cannot be met by any object.
    """
    from artigen.sketch.request import encode_request

    understood = _understand(job)
    encode_request(understood.request)
    return understood
