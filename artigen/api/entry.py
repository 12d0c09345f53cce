"""What ``import artigen`` offers: objects by kind, by words or picture, by file and by folder."""

from collections.abc import Mapping, Sequence
from functools import partial
from numbers import Integral
from pathlib import Path
from typing import Literal, TypedDict, Unpack, get_args, overload

from artigen.api.convert import (
    TIMEOUT,
    Collision,
    ConvertSettings,
    Direction,
    convert_and_validate,
    list_conversions,
)
from artigen.api.generate import GenerateSettings, generate_and_validate, list_jobs, understand_job
from artigen.api.object import Object
from artigen.api.objects import Objects, list_seeds, make_here
from artigen.api.sample import (
    ShapeJob,
    ShapeSettings,
    build_sampled,
    draw_wished,
    export_and_validate,
    export_only,
    list_shapes,
)
from artigen.errors import ArtigenError, check_option
from artigen.types import PartLabel
from artigen.weights import SHIPPED

Counts = Mapping[PartLabel, int]
"""Number of parts by label, such as ``{"drawer": 3, "door": 0}``; labels that are not named are free."""
HERE = Path()
"""Stands for the folder of a job whose object is not written."""


class Look(TypedDict, total=False):
    """Options of drawn objects."""

    width: float | None
    depth: float | None
    height: float | None
    style: str | None
    counts: Counts | None
    gaussians: bool
    workers: int


class SampleOptions(Look, total=False):
    """Options of `sample`."""

    family: str | None
    suite: int | None
    like: int | None


class GenerateOptions(Look, total=False):
    """Options of `generate`."""

    image: Path | str | None
    box: tuple[float, float, float, float] | None
    reading: Path | str | None
    kind: str | None
    structure: Literal["sketch", "latent"]
    temperature: float
    redraws: int
    model: Path


class ConvertOptions(TypedDict, total=False):
    """Options of `convert`."""

    mend: bool
    size: float | None
    kind: str | None
    up: Direction | None
    front: Direction | None
    body: str | None
    arguments: Mapping[str, object] | None
    visual: Literal["source", "voxels"]
    gaussians: bool
    budget: float
    collision: Collision
    coacd: str
    workers: int


@overload
def sample(kind: str, seed: int = 0, *, count: None = None, **options: Unpack[SampleOptions]) -> Object: ...
@overload
def sample(kind: str, seed: int = 0, *, count: int, **options: Unpack[SampleOptions]) -> Objects: ...
@overload
def sample(kind: str, seed: Sequence[int], **options: Unpack[SampleOptions]) -> Objects: ...
def sample(
    kind: str,
    seed: int | Sequence[int] = 0,
    *,
    count: int | None = None,
    width: float | None = None,
    depth: float | None = None,
    height: float | None = None,
    style: str | None = None,
    counts: Counts | None = None,
    family: str | None = None,
    suite: int | None = None,
    like: int | None = None,
    gaussians: bool = False,
    workers: int = 0,
) -> Object | Objects:
    """Samples an object from the procedural grammar: exact, in milliseconds, without a network.

    Args:
        kind: Name of a kind, or a noun for it, such as ``StorageFurniture`` or ``cabinet``; see `kinds`.
        seed: Seed of the object, or a sequence of seeds for as many.
        count: Number of objects with consecutive seeds; a lazy sequence of them is returned. Numbers of
            objects in ``words`` are not taken for it.
        width: Metres, seen from the front; lengths that are not stated are sampled.
        depth: Metres, with fronts and without handles.
        height: Metres.
        style: Style of the kind, such as ``shaker``.
        counts: Number of parts by label; the others are free.
        family: Look across kinds, such as ``industrial``.
        suite: Choice of the family's materials and hardware; objects of one suite match.
        like: Seed of a template whose links, joints and kinds of collision shapes are kept.
        gaussians: Whether the package has 3D Gaussians.
        workers: Processes for many objects; 0 makes them in this one.

    Raises:
        ArtigenError: If the kind is unknown, or no object meets the wishes.
    """
    cfg = ShapeSettings(
        width=width, depth=depth, height=height, style=style, counts=_write_counts(counts), family=family,
        suite=suite, like=like, splats=gaussians,
    )  # fmt: skip
    jobs = list_shapes(kind, HERE, list_seeds(seed, count), cfg)
    if isinstance(seed, Integral) and count is None:
        return make_sampled(jobs[0])
    return Objects(
        jobs=tuple(jobs), make=make_sampled, handle=export_and_validate, write=export_only, workers=workers
    )


def make_sampled(job: ShapeJob) -> Object:
    """The object of a job of the grammar; its package is built when it is used."""
    drawn = draw_wished(job)
    return Object(name=job.key, kind=job.category, build=partial(build_sampled, job, drawn), shape=drawn)


@overload
def generate(
    words: str | None = None, *, seed: int = 0, count: None = None, **options: Unpack[GenerateOptions]
) -> Object: ...
@overload
def generate(
    words: str | None = None, *, seed: int = 0, count: int, **options: Unpack[GenerateOptions]
) -> Objects: ...
@overload
def generate(
    words: str | None = None, *, seed: Sequence[int], **options: Unpack[GenerateOptions]
) -> Objects: ...
def generate(
    words: str | None = None,
    *,
    image: Path | str | None = None,
    box: tuple[float, float, float, float] | None = None,
    reading: Path | str | None = None,
    kind: str | None = None,
    counts: Counts | None = None,
    seed: int | Sequence[int] = 0,
    count: int | None = None,
    width: float | None = None,
    depth: float | None = None,
    height: float | None = None,
    style: str | None = None,
    structure: Literal["sketch", "latent"] = "sketch",
    temperature: float = GenerateSettings.temperature,
    redraws: int = GenerateSettings.redraws,
    gaussians: bool = True,
    model: Path = SHIPPED,
    workers: int = 0,
) -> Object | Objects:
    """Generates an object from words, a photograph, a kind or counts with the trained model.

    An object that fails a check (L0 to L3) is drawn again, at most ``redraws`` times; `Object.report` of what
    is returned states the verdict on the last draw.

    Args:
        words: A description in English, such as ``a white fridge with black handles``.
        image: Photograph of one object, taken from near its front.
        box: Left, top, right and bottom of the object in the photograph, as shares of width and height;
            default: the largest object.
        reading: File that ``artigen read --json`` wrote, edited or not, instead of a photograph.
        kind: Name of a kind, or a noun for it; default: as words or picture say.
        counts: Number of parts by label; the others are free.
        seed: Seed of the object, or a sequence of seeds for as many.
        count: Number of objects with consecutive seeds; a lazy sequence of them is returned. Numbers of
            objects in ``words`` are not taken for it.
        width: Metres, seen from the front; lengths that are not stated are sampled.
        depth: Metres, with handles.
        height: Metres.
        style: Style of the kind, such as ``shaker``.
        structure: ``sketch`` for exact solids; ``latent`` for voxels that the paper's latents give within the
            boxes of the sketch.
        temperature: Sampling temperature; 1 matches the training data, lower is less varied.
        redraws: Most new draws of an object that fails a check.
        gaussians: Whether the package has 3D Gaussians.
        model: Folder of a trained model; default: the shipped one.
        workers: Processes for many objects; 0 makes them in this one.

    Raises:
        ArtigenError: If no object can be as asked, the picture cannot be read, or no draw can be exported.
    """
    cfg = GenerateSettings(
        text=words, image=None if image is None else Path(image), box=box,
        reading=None if reading is None else Path(reading), width=width, depth=depth, height=height,
        style=style, counts=_write_counts(counts), structure=structure, temperature=temperature,
        redraws=redraws, gaussians=gaussians, compare=False,
    )  # fmt: skip
    check_option("structure", structure, ("sketch", "latent"))
    jobs = list_jobs(HERE, list_seeds(seed, count), cfg, category=kind, model=Path(model))
    understand_job(jobs[0])
    make = partial(make_here, handle=generate_and_validate)
    if isinstance(seed, Integral) and count is None:
        return make(jobs[0])
    handle = generate_and_validate
    return Objects(jobs=tuple(jobs), make=make, handle=handle, write=handle, workers=workers)


@overload
def convert(source: Path | str, **options: Unpack[ConvertOptions]) -> Object: ...
@overload
def convert(source: Sequence[Path | str], **options: Unpack[ConvertOptions]) -> Objects: ...
def convert(
    source: Path | str | Sequence[Path | str],
    *,
    mend: bool = False,
    size: float | None = None,
    kind: str | None = None,
    up: Direction | None = None,
    front: Direction | None = None,
    body: str | None = None,
    arguments: Mapping[str, object] | None = None,
    visual: Literal["source", "voxels"] = "source",
    gaussians: bool = False,
    budget: float = 30.0,
    collision: Collision = "auto",
    coacd: str = "",
    workers: int = 0,
) -> Object | Objects:
    """Converts an object of a URDF, xacro, MJCF, USD, SDF or mesh with joints, or of a data set.

    It keeps its own meshes and gets convex hulls, masses, friction and handles. `Object.report` states the
    verdict of the checks.

    Args:
        source: A file or folder of one object; or a list of files and folders, for a lazy sequence of all
            objects in them.
        mend: Repair faults of the source, each recorded in ``meta.json``.
        size: Longest edge of the closed object in metres; default: as in the file, else usual for its kind.
        kind: Kind of the object; default: from its files and its name.
        up: Up axis of the source; default: z, or y in ``object.json``.
        front: Axis that its front faces; default: -x, or z in ``object.json``.
        body: Body of a scene file that is the object; default: every object in the file.
        arguments: Arguments of a xacro.
        visual: Keep the meshes, or rebuild the object from its 64^3 voxels.
        gaussians: Whether the package has 3D Gaussians.
        budget: Seconds of one core per object; the best package found in them is made.
        collision: Who makes the hulls: our search, exact boxes and cylinders, CoACD or V-HACD.
        coacd: Parameters of CoACD, such as ``threshold=0.03,max_convex_hull=32``.
        workers: Processes for many objects; 0 makes them in this one.

    Raises:
        ArtigenError: If the source cannot be read, or holds several objects where one is expected.
    """
    cfg = ConvertSettings(
        mend=mend,
        size=size,
        category=kind,
        up=up,
        front=front,
        body=body,
        arguments=tuple(f"{name}:={value}" for name, value in (arguments or {}).items()),
        visual=visual,
        splats=gaussians,
        budget=budget,
        collision=collision,
        coacd=coacd,
    )
    for name, direction in (("up", up), ("front", front)):
        if direction is not None:
            check_option(name, direction, get_args(Direction))
    check_option("visual", visual, ("source", "voxels"))
    check_option("collision", collision, get_args(Collision))
    one = isinstance(source, str | Path)
    given = (Path(source),) if isinstance(source, str | Path) else tuple(map(Path, source))
    jobs = tuple(list_conversions(given, HERE, cfg))
    handle = partial(convert_and_validate, timeout=TIMEOUT)
    make = partial(make_here, handle=handle)
    if not one:
        return Objects(jobs=jobs, make=make, handle=handle, write=handle, workers=workers)
    if len(jobs) != 1:
        raise ArtigenError(
            f"{source}: {len(jobs)} objects, expected one; for all of them give a list, as in "
            f"convert([{str(source)!r}])"
        )
    return make(jobs[0])


def _write_counts(counts: Counts | None) -> tuple[str, ...]:
    """Counts of parts as settings hold them."""
    return tuple(f"{label}={number}" for label, number in (counts or {}).items())
