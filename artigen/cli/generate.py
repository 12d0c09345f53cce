"""`artigen generate`: from a category, words or a picture to proven packages, drawn again where one fails."""

import json
import math
import resource
import sys
import time
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import tyro

from artigen.cli.arguments import Count, Out, Workers
from artigen.cli.batch import Finished, Made, make_and_validate, run_shown
from artigen.cli.shape import read_counts
from artigen.errors import ArtigenError
from artigen.weights import SHIPPED
from artigen.workers import Worker

if TYPE_CHECKING:
    from artigen.appearance import AppearanceModel
    from artigen.ask import Asked, Request
    from artigen.generate import StructureModel
    from artigen.models.conditions import ConditionConfig

TIMEOUT = 300.0
"""Seconds that drawing and exporting one object may take."""


@dataclass(frozen=True, kw_only=True)
class GenerateSettings:
    """What is asked for (what is not said is left to the seed), and how objects are drawn."""

    text: str | None = None
    """A description in English, such as "a tall cabinet with three drawers and two doors"."""
    image: Path | None = None
    """A picture of one object from near its front, cut out or before a plain background."""
    width: float | None = None
    """Metres, as seen from the front."""
    depth: float | None = None
    """Metres."""
    height: float | None = None
    """Metres."""
    counts: tuple[str, ...] = ()
    """Parts wanted, such as drawer=3 door=0."""
    redraws: int = 3
    """How often an object that fails a check is drawn again."""
    steps: int = 6
    """Steps of the structure's sampler."""
    encoders: Path | None = None
    """Folder with the public weights of DINOv2 and CLIP, for models that read conditions with these."""
    strength: float = 0.0
    """Guidance; 0 is none: a model that draws outlines has the condition in them. The paper: 3."""


@dataclass(frozen=True, kw_only=True)
class GenerateJob:
    """One object on its way to its package folder; ``draws`` says what became of earlier draws of it."""

    model: Path
    category: str | None
    seed: int
    out: Path
    cfg: GenerateSettings = field(default_factory=GenerateSettings)
    draws: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        """Name of the package."""
        return f"{self.category or 'object'}_{self.seed}"

    @property
    def settings(self) -> str:
        """Object, model and settings as text."""
        return f"{self.key} {self.model} {self.cfg}"


def read_job(job: GenerateJob) -> "Request":
    """What a job asks for."""
    from artigen.ask import Request
    from artigen.shapes.draw import Wish

    cfg = job.cfg
    wish = Wish(width=cfg.width, depth=cfg.depth, height=cfg.height, counts=read_counts(cfg.counts))
    return Request(category=job.category, text=cfg.text, image=cfg.image, wish=wish)


def _read(job: GenerateJob, known: "ConditionConfig") -> "Asked":
    """What a job asks of a network with such conditions."""
    from artigen.ask import read_request

    return read_request(read_job(job), job.seed, known.image_size, margin=known.image_margin)


@lru_cache(maxsize=1)
def _load(folder: Path, encoders: Path | None) -> tuple["StructureModel", "AppearanceModel | None"]:
    """The models of a worker process, loaded once; without appearance where the folder has none."""
    from artigen.appearance import has_appearance, load_appearance_model
    from artigen.generate import load_structure_model
    from artigen.models.public_encoders import attach_encoders

    structure = load_structure_model(folder)
    if encoders is not None:
        attach_encoders(structure.flow, encoders)
    return structure, load_appearance_model(folder) if has_appearance(folder) else None


def generate_object(job: GenerateJob) -> Made:
    """Draws one object, exports it and writes its package; runs in a worker process."""
    from artigen import __version__
    from artigen.appearance import AppearanceConfig, generate_appearance
    from artigen.generate import GenerateConfig, generate_structure
    from artigen.models.picture_reader import read_condition
    from artigen.models.store import hash_model
    from artigen.sampling import SamplerConfig
    from sim_export.export import export_asset
    from sim_export.files.write import write_package
    from sim_export.geometry.surface import sample_surface

    model, appearance = _load(job.model, job.cfg.encoders)
    started = time.perf_counter()
    asked = _read(job, model.preset.conditions)
    noise = np.random.SeedSequence([job.seed, len(job.draws)]).generate_state(2).tolist()
    sampler = SamplerConfig(steps=job.cfg.steps, strength=job.cfg.strength)
    condition, read = asked.condition, ()
    if model.reader is not None:
        condition, read = read_condition(model.reader, condition)
    asset = generate_structure(model, condition, noise[0], GenerateConfig(sampler=sampler))
    asset = replace(asset, name=job.key, notes=(*asked.notes, *read, *asset.notes))
    drawn = time.perf_counter()
    if appearance is not None:
        look = _read(job, appearance.preset.conditions)
        painting = AppearanceConfig(colors=look.colors)
        surface = sample_surface(asset)
        asset = generate_appearance(appearance, asset, look.condition, noise[1], painting, surface=surface)
    elif asked.colors:
        named = ", ".join(f"{label} {color}" for label, color in asked.colors)
        said = f"colours were asked for ({named}), this model draws none"
        asset = replace(asset, notes=(*asset.notes, said))
    painted = time.perf_counter()
    provenance = {
        "generator": f"artigen {__version__} generate",
        "model": hash_model(job.model),
        "condition": json.dumps(
            {
                "category": condition.category,
                "counts": dict(condition.counts),
                "size": condition.size,
                "text": job.cfg.text,
                "image": None if job.cfg.image is None else job.cfg.image.name,
            }
        ),
        "seed": str(job.seed),
        "draws": json.dumps([*job.draws, "this one"]),
    }
    package = export_asset(asset, provenance=provenance).package
    exported = time.perf_counter()
    write_package(package, job.out / job.key, "replace")
    return Made(
        seconds=(
            ("draw", drawn - started),
            ("paint", painted - drawn),
            ("export", exported - painted),
            ("write", time.perf_counter() - exported),
        ),
        peak_mib=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        notes=package.records,
    )


def generate_and_validate(worker: Worker, job: GenerateJob) -> Finished:
    """Draws an object until it passes every check, at most ``redraws`` times again.

    What fails last stays where it is, with its report; every draw is in its provenance.
    """
    finished = make_and_validate(worker, job, generate_object, timeout=TIMEOUT, validation=True)
    while not finished.good and len(job.draws) < job.cfg.redraws:
        reason = finished.error or "; ".join(finished.failures)
        job = replace(job, draws=(*job.draws, reason))
        finished = make_and_validate(worker, job, generate_object, timeout=TIMEOUT, validation=True)
    return replace(finished, notes=(*finished.notes, f"{len(job.draws) + 1} draws"))


def generate(
    out: Out,
    model: Path = SHIPPED,
    category: tyro.conf.Positional[str | None] = None,
    seed: int = 0,
    count: Count = 1,
    cfg: tyro.conf.OmitArgPrefixes[GenerateSettings] = GenerateSettings(),
    workers: Workers = 2,
) -> int:
    """Generates articulated objects from a category, words or a picture, as proven packages.

    A killed or failed run is finished by running the same command again.

    Args:
        out: Folder for the packages and the journal run.jsonl.
        model: Folder of a trained model, model.json and its weights; left out, the one that comes with
            artigen. Where it has weights of appearance too, packages have textures made from Gaussians, and
            the Gaussians themselves.
        category: What to generate, such as StorageFurniture; not needed beside --text or --image.
        seed: Seed of the first object.
        count: Number of objects; seeds follow each other.
        cfg: What is asked for, and how objects are drawn.
        workers: Processes side by side.
    """
    if count < 1 or seed < 0 or cfg.redraws < 0 or workers < 1:
        raise ArtigenError(
            f"{count} objects from seed {seed} with {cfg.redraws} redraws by {workers} workers: expected at "
            "least one object and one worker, and nothing below 0"
        )
    if cfg.steps < 1 or not 0 <= cfg.strength < math.inf:
        raise ArtigenError(
            f"{cfg.steps} steps, strength {cfg.strength:g}: expected at least one step, no strength below 0"
        )
    jobs = [
        GenerateJob(model=model, category=category, seed=number, out=out, cfg=cfg)
        for number in range(seed, seed + count)
    ]
    # Says at once what cannot be: no such model, category, sentence or picture.
    known = _load(model, cfg.encoders)[0].preset.conditions
    asked = _read(jobs[0], known).condition
    if asked.category is not None and asked.category not in known.categories:
        raise ArtigenError(
            f"category {asked.category!r}: this model knows {', '.join(sorted(known.categories))}; "
            "artigen shape draws others"
        )
    results = run_shown(generate_and_validate, jobs, out, workers=workers)
    passed = sum(bool(finished.passed) for finished in results)
    written = sum(finished.error is None for finished in results)
    sys.stdout.write(f"{len(results)} objects: {written} packages in {out}, {passed} passed every check\n")
    return 0 if all(finished.good for finished in results) else 1
