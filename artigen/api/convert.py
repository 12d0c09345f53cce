"""Converts URDFs, MJCFs, USD, SDFs, meshes, PartNet-Mobility folders and object.json to packages."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Literal

import numpy as np

from artigen.api.batch import Finished, Laps, Made, Part, run_with_progress
from artigen.api.grids import GRIDS, make_on_grids
from artigen.errors import ArtigenError, list_some
from artigen.runtime.runner import Runner
from artigen.runtime.workers import Worker

Collision = Literal["auto", "exact", "coacd", "vhacd"]
Direction = Literal["x", "-x", "y", "-y", "z", "-z"]
if TYPE_CHECKING:
    from artigen.datasets.source_object import SourceObject
    from artigen.runtime.budget import Budget
    from artigen.types import Asset
    from sim_export.export import Exported
    from sim_export.package import SimPackage
    from sim_export.search import HullPlan


@dataclass(frozen=True, kw_only=True)
class ConvertSettings:
    """How objects are converted; equal settings give equal packages."""

    visual: Literal["source", "voxels"] = "source"
    """``source`` keeps the object's own textured meshes and adds collision hulls, mass and friction;
    ``voxels`` rebuilds the object from its 64^3 articulated voxels, as the paper represents it, and from 96^3
    and 128^3 voxels while its package fails validation."""
    recipe: Literal["robust", "paper"] = "robust"
    """Segmentation of the voxels into parts: our robust recipe or that of the paper."""
    size: float | None = None
    """Longest edge of the closed object in metres; default: as in the URDF, else usual for its category."""
    category: str | None = None
    """Category of the objects; default: from their files and names."""
    up: Direction | None = None
    """Up axis of a URDF, MJCF, USD or object.json; default: z, or y in object.json."""
    front: Direction | None = None
    """Axis that the front faces; default: -x in a URDF, MJCF or USD, z in object.json."""
    body: str | None = None
    """Body of a scene file that is the object; default: every object in the file becomes a package."""
    arguments: tuple[str, ...] = ()
    """Arguments of a xacro, name:=value each."""
    seed: int = 0
    """Seed of the surface samples."""
    splats: bool = False
    """Add 3D Gaussians to the package: flat discs on the surface, one PLY per link."""
    mend: bool = False
    """Mend faults of the source before converting it: sizes that no object of the kind has (unless ``size``
    is given), hinges off the edge of their door, parts inside each other, ranges that run into the body,
    handles out of reach, pieces that float or belong to another link, objects that fall over. Every change is
    in meta.json."""
    validation: Literal["full", "none"] = "full"
    """Run checks L0 to L3 on every package right after it is written."""
    budget: float = 30.0
    """Seconds of one core in which an object is read and its hulls are searched for. The best package found
    is always written; meta.json says where the budget ended the search."""
    collision: Collision = "auto"
    """Who makes the collision hulls: our search, the exact boxes and cylinders of a source that consists of
    such, CoACD or V-HACD. The last two must end within the budget and are not refined."""
    coacd: str = ""
    """Parameters of CoACD, such as threshold=0.03,max_convex_hull=32; others have its defaults."""


@dataclass(frozen=True, kw_only=True)
class ConvertJob:
    """Job to convert one source object to a package."""

    source: Path
    out: Path
    cfg: ConvertSettings = field(default_factory=ConvertSettings)
    grid: int = GRIDS[0]
    """Cells along the longest edge of the object's voxels."""

    @property
    def key(self) -> str:
        """Name of the package: that of the source, with the chosen body."""
        from artigen.datasets.sources import name_source

        body = "" if self.cfg.body is None else "_" + re.sub(r"\W", "_", self.cfg.body)
        return name_source(self.source) + body

    @property
    def settings(self) -> str:
        """Content of the source and settings as text; an object whose files change is converted again."""
        from artigen.datasets.contents import digest_source

        return f"{self.key} {digest_source(self.source)} {self.cfg}"

    def read(self, scratch: Path) -> "SourceObject":
        """Reads the source and mends it if requested; converted meshes go into ``scratch``."""
        from artigen.api.mend import mend_object, resize_object
        from artigen.datasets.source_object import ReaderConfig
        from artigen.datasets.sources import read_source

        cfg = self.cfg
        reader = ReaderConfig(
            samples=round(ReaderConfig.samples * (self.grid / GRIDS[0]) ** 2),
            seed=cfg.seed,
            size=cfg.size,
            category=cfg.category,
            up=cfg.up,
            front=cfg.front,
            body=cfg.body,
            arguments=cfg.arguments,
        )
        source = read_source(self.source, scratch, reader)
        if not cfg.mend:
            return source
        if cfg.size is None:
            source = resize_object(source)
        cell = source.asset.scale / self.grid if cfg.visual == "voxels" else 0.0
        return mend_object(source, scratch, cell)


def list_jobs(source: Path, out: Path, cfg: ConvertSettings) -> list[ConvertJob]:
    """A job for every object in a source; one that cannot be read fails when its job runs."""
    from artigen.datasets.sources import list_objects
    from artigen.errors import SourceError

    try:
        bodies = list_objects(source) if cfg.body is None else ()
    except SourceError:
        bodies = ()
    return [ConvertJob(source=source, out=out, cfg=replace(cfg, body=body)) for body in bodies or (cfg.body,)]


def convert_object(job: ConvertJob) -> Made:
    """Reads one object, exports it and writes the package; runs in a worker process."""
    with TemporaryDirectory() as scratch:
        return _convert(job, Path(scratch))


def _convert(job: ConvertJob, scratch: Path) -> Made:
    from artigen import __version__
    from artigen.datasets.sources import find_layout
    from artigen.runtime.budget import Budget
    from artigen.splats.surface import RANDOM
    from sim_export.appearance.splats import splat_package
    from sim_export.export import export_asset
    from sim_export.files.write import write_package
    from sim_export.mend.stand import stand_on_side
    from sim_export.physics.followers import follow_parts

    laps, budget = Laps(), Budget(job.cfg.budget)
    source = job.read(scratch)
    laps.end("read")
    provenance = {
        "generator": f"artigen {__version__} convert",
        "source": f"{job.key} ({source.asset.category}), {find_layout(job.source)} layout",
        "visual": job.cfg.visual,
        "seed": str(job.cfg.seed),
    }
    asset = voxelize_object(source.asset, job.grid)
    laps.end("voxelize")

    def finish(package: "SimPackage") -> "SimPackage":
        package = splat_package(package, asset, RANDOM) if job.cfg.splats else package
        package = stand_on_side(package) if job.cfg.mend else package
        return follow_parts(package, dict(source.follows))

    if job.cfg.visual == "voxels":
        asset = rebuild_from_voxels(asset, job.cfg.recipe)
        laps.end("segment")
        provenance |= {"grid": str(job.grid)}
        first = replace(plan_hulls(job.cfg), target="voxels")
        exported = export_asset(asset, provenance=provenance, finish=finish, budget=budget, first=first)
    else:
        exported = export_source(source, asset, provenance, finish, budget, first=plan_hulls(job.cfg))
    laps.end("export", *exported.seconds)
    write_package(exported.package, job.out / job.key, "replace")
    laps.end("write")
    return laps.made(exported.package.records)


def voxelize_object(asset: "Asset", grid: int = GRIDS[0]) -> "Asset":
    """Adds the voxels of the surface; parts below the grid's resolution are merged into their parents."""
    from artigen.voxels.voxelize import drop_unresolved, voxelize

    if asset.surface is None:
        raise ValueError(f"asset {asset.name!r} has no surface to voxelize")
    return drop_unresolved(replace(asset, voxels=voxelize(asset.surface, grid)))


def rebuild_from_voxels(asset: "Asset", recipe: Literal["robust", "paper"] = "robust") -> "Asset":
    """Encodes the object as a 35-channel field and back; besides that, only surface colours are kept."""
    from artigen.datasets.relabel import carry_surface, restore_tree
    from artigen.voxels.fields import decode, encode
    from artigen.voxels.segmentation.segment import SegmentConfig, segment

    fields = decode(encode(asset))
    found = segment(
        fields,
        SegmentConfig(recipe=recipe, detached="note"),
        name=asset.name,
        scale=asset.scale,
        category=asset.category,
    )
    found = carry_surface(asset, replace(found, notes=asset.notes + found.notes))
    return restore_tree(asset, found)


def plan_hulls(cfg: ConvertSettings) -> "HullPlan":
    """How hulls are made first by some settings.

    Raises:
        ArtigenError: If CoACD has parameters that cannot be read, or is not who makes the hulls.
    """
    from sim_export.collision.tools import read_options
    from sim_export.search import HullPlan

    if cfg.coacd and cfg.collision != "coacd":
        raise ArtigenError(f"coacd={cfg.coacd!r}: hulls are made by {cfg.collision}; add --collision coacd")
    return HullPlan(method=cfg.collision, options=tuple(read_options(cfg.coacd).items()))


def export_source(
    source: "SourceObject",
    asset: "Asset",
    provenance: dict[str, str],
    finish: Callable[["SimPackage"], "SimPackage"] = lambda package: package,
    budget: "Budget | None" = None,
    first: "HullPlan | None" = None,
) -> "Exported":
    """A package with the object's own meshes, and the hulls of these that fail fewest static checks.

    Raises:
        ExportError: If no hulls can be made.
    """
    from artigen.api.mend import place_source_meshes, place_source_surfaces
    from sim_export.export import export_best
    from sim_export.search import HullPlan
    from sim_export.solids import make_solids

    solids = make_solids(asset, place_source_surfaces(source, asset))
    meshes = place_source_meshes(source, asset)
    return export_best(
        solids,
        first or HullPlan(),
        source_meshes=meshes,
        provenance=provenance,
        finish=finish,
        budget=budget,
    )


def convert_and_validate(worker: Worker, job: ConvertJob, timeout: float) -> Finished:
    """Converts and validates one object, from voxels on finer grids while it fails."""
    grids = GRIDS if job.cfg.visual == "voxels" else GRIDS[:1]
    jobs = [replace(job, grid=grid) for grid in grids]
    full = job.cfg.validation == "full"
    finished = make_on_grids(worker, jobs, convert_object, timeout=timeout, validation=full)
    if finished.passed is not False:
        return finished
    failed = tuple(dict.fromkeys(failure.split(" ")[0] for failure in finished.failures))
    outcome = worker.call(explain_failures, (job, failed), timeout)
    return replace(finished, as_in_source=outcome.value or ())


def explain_failures(job: tuple[ConvertJob, tuple[str, ...]]) -> tuple[str, ...]:
    """Check and evidence of each failed check that the source fails as well; runs in a worker process."""
    with TemporaryDirectory() as scratch:
        return _explain(*job, Path(scratch))


def _explain(job: ConvertJob, failed: tuple[str, ...], scratch: Path) -> tuple[str, ...]:
    from artigen.api.mend import place_source_meshes, place_source_surfaces
    from sim_export.checks.subject import Subject
    from sim_export.export import export_solids
    from sim_export.files.read import read_package
    from sim_export.search import HullPlan
    from sim_export.solids import make_solids
    from sim_export.source_faults import find_source_faults

    if job.cfg.visual == "source":
        subject = Subject(job.out / job.key)
        package = read_package(job.out / job.key)
        shown = {
            link: np.concatenate([shape.triangles for shape in subject.visuals if shape.link == link])
            for link in {shape.link for shape in subject.visuals}
        }
    else:
        source = job.read(scratch)
        asset = voxelize_object(source.asset)
        meshes = place_source_meshes(source, asset)
        package = export_solids(make_solids(asset), HullPlan(target="voxels"), source_meshes=meshes).package
        surfaces = dict(
            zip((part.name for part in asset.parts), place_source_surfaces(source, asset), strict=True)
        )
        shown = {
            link.name: np.concatenate([surfaces[part] for part in link.parts])
            for link in package.links
            if link.parts
        }
    return tuple(f"{check} {said}" for check, said in find_source_faults(package, shown, failed).items())


TIMEOUT = 300.0
"""Time limit in seconds for one stage of one object."""


def convert_packages(
    sources: Sequence[Path],
    out: Path,
    cfg: ConvertSettings | None = None,
    *,
    runner: Runner,
    timeout: float = TIMEOUT,
    part: Part | None = None,
) -> list[Finished]:
    """Converts objects into a folder of packages with a journal; finished ones are kept.

    Args:
        sources: URDF, xacro, MJCF, USD, SDF or mesh files, object folders, or folders that contain either.
        out: Folder of the packages and the journal.
        cfg: How objects are converted.
        runner: Where objects are converted.
        timeout: Time limit in seconds for one stage of one object.
        part: Part of the objects to convert; None for all.

    Raises:
        ArtigenError: If a source is not there, or several have one name.
    """
    jobs = list_conversions(sources, out, cfg or ConvertSettings())
    return run_with_progress(
        partial(convert_and_validate, timeout=timeout), jobs, out, runner=runner, part=part
    )


def list_conversions(sources: Sequence[Path], out: Path, cfg: ConvertSettings) -> list[ConvertJob]:
    """One job for every object in some files and folders.

    Raises:
        ArtigenError: If there are none, one is not there, or a number is out of its range.
    """
    from artigen.datasets.sources import find_sources

    if not sources:
        raise ArtigenError("no sources: expected files or folders of objects")
    missing = [str(source) for source in sources if not source.exists()]
    if missing:
        raise ArtigenError(f"{list_some(missing)}: no such file or folder")
    if cfg.budget < 0 or (cfg.size is not None and not 0 < cfg.size < math.inf):
        raise ArtigenError(
            f"size {cfg.size} m, budget {cfg.budget:g} s: expected a size above 0 and no budget below 0"
        )
    return [job for source in find_sources(tuple(sources)) for job in list_jobs(source, out, cfg)]
