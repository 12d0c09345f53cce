"""Generation, validation, description and packing of the objects of a data set, one folder each."""

import json
import os
import resource
import shutil
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, get_args

from artigen.api.batch import Finished, digest_settings
from artigen.api.generate import (
    TIMEOUT,
    GenerateJob,
    GenerateSettings,
    generate_and_validate,
)
from artigen.api.sample import ShapeJob, ShapeSettings, export_and_validate
from artigen.datasets.duplicates import Fingerprint
from artigen.datasets.packing import LISTING, PackedFiles, digest, pack_files, read_folder
from artigen.datasets.publish import PackedObject
from artigen.datasets.recipe import Entry, Options
from artigen.datasets.samples import (
    Count,
    DrivenJoint,
    Sample,
    SampleHandle,
    Vector,
    sample_from_json,
    sample_json,
)
from artigen.io import whole_folder
from artigen.runtime.workers import Worker
from artigen.types import PartLabel
from artigen.weights import SHIPPED

if TYPE_CHECKING:
    from sim_export.package import SimPackage
    from sim_export.report import Report

PACKAGES = ".packages"
"""Subfolder of the work folder for packages that are not packed yet."""
SHARED = "shared"
LARGE_MIB = 1200.0
"""Resident memory above which a worker process is replaced; a fresh one has 300 MiB, or 700 MiB with the
model."""
SAMPLE, ARCHIVE, THUMBNAIL, DESCRIPTOR = "sample.json", "files.tar.zst", "thumbnail.webp", "descriptor.bin"


@dataclass(frozen=True, kw_only=True)
class ObjectJob:
    """One object of a data set."""

    inner: ShapeJob | GenerateJob
    """Job that makes the package."""
    out: Path
    """Work folder."""
    validation: bool
    thumbnail: int

    @property
    def key(self) -> str:
        """Id of the object."""
        return self.inner.key

    @property
    def settings(self) -> str:
        """Everything that determines the object, as text."""
        return f"{self.inner.settings} validation {self.validation} thumbnail {self.thumbnail}"


def make_job(entry: Entry, options: Options, work: Path, seed: int, *, by_model: bool) -> ObjectJob:
    """The job of one object of an entry."""
    wish, packages = entry.wish, work / PACKAGES
    counts = tuple(f"{label}={count}" for label, count in wish.counts)
    inner: ShapeJob | GenerateJob
    if by_model:
        drawn = GenerateSettings(
            width=wish.width, depth=wish.depth, height=wish.height, style=wish.style, counts=counts,
            redraws=options.redraws, gaussians=options.gaussians,
        )  # fmt: skip
        name = f"{entry.name}-g{seed}"
        inner = GenerateJob(
            model=SHIPPED, category=entry.category, seed=seed, out=packages, cfg=drawn, name=name
        )
    else:
        made = ShapeSettings(
            width=wish.width, depth=wish.depth, height=wish.height, style=wish.style, counts=counts,
            like=entry.like, splats=options.gaussians,
            validation=options.validation,
        )  # fmt: skip
        inner = ShapeJob(
            category=entry.category, seed=seed, out=packages, cfg=made, name=f"{entry.name}-{seed}"
        )
    return ObjectJob(
        inner=inner, out=work, validation=options.validation == "full", thumbnail=options.thumbnail
    )


def make_and_pack(worker: Worker, job: ObjectJob) -> Finished:
    """Makes, validates and packs one object in a supervised process; a failed object leaves no files
    behind."""
    inner = job.inner
    if isinstance(inner, ShapeJob):
        finished = export_and_validate(worker, inner)
    else:
        finished = generate_and_validate(worker, inner, validation=job.validation)
    finished = replace(finished, settings=digest_settings(job.settings))
    if not finished.good:
        shutil.rmtree(inner.out / inner.key, ignore_errors=True)
        return finished
    outcome = worker.call(pack_object, job, TIMEOUT)
    if outcome.value is None:
        return replace(finished, error=outcome.error)
    seconds, resident = outcome.value
    restart_large(worker, resident)
    return replace(finished, seconds=(*finished.seconds, ("pack", seconds)))


def restart_large(worker: Worker, resident_mib: float) -> None:
    """Ends a worker process above `LARGE_MIB`; the next object starts a new one.

    Validating an object leaks about one megabyte in the process.
    """
    if resident_mib > LARGE_MIB:
        worker.close()


def pack_object(job: ObjectJob) -> tuple[float, float]:
    """Describes a package, splits it into shared and own files and removes it. Returns the time (seconds) and
    the resident memory (MiB) of the process."""

    from sim_export.files.read import read_package
    from sim_export.fingerprint import describe_surface, quantise
    from sim_export.picture.preview import draw_thumbnail, webp_bytes
    from sim_export.report import report_from_json

    started = time.perf_counter()
    folder = job.inner.out / job.key
    report = report_from_json((folder / "validation.json").read_text()) if job.validation else None
    package = read_package(folder)
    files = read_folder(folder)
    packed = pack_files(files)
    sample = describe_object(job, package, report, files, packed)
    for name, data in packed.contents.items():
        _keep_shared(job.out / SHARED / name, data)
    with whole_folder(job.out / job.key) as record:
        (record / SAMPLE).write_bytes(sample_json(sample))
        (record / ARCHIVE).write_bytes(packed.archive)
        (record / THUMBNAIL).write_bytes(webp_bytes(draw_thumbnail(package, job.thumbnail)))
        (record / DESCRIPTOR).write_bytes(quantise(describe_surface(package)))
    shutil.rmtree(folder)
    return time.perf_counter() - started, _resident_mib()


def _resident_mib() -> float:
    """Resident memory of this process; its peak where the system does not report the current value (not
    Linux)."""
    statm = Path("/proc/self/statm")
    if not statm.is_file():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return int(statm.read_text().split()[1]) * resource.getpagesize() / 2**20


def load_object(work: Path, name: str) -> PackedObject:
    """A packed object by its id."""
    record = work / name
    return PackedObject(
        sample=sample_from_json((record / SAMPLE).read_bytes()),
        thumbnail=(record / THUMBNAIL).read_bytes(),
        archive=(record / ARCHIVE).read_bytes(),
        descriptor=(record / DESCRIPTOR).read_bytes(),
    )


def read_fingerprint(work: Path, name: str) -> tuple[Sample, Fingerprint]:
    """Description and fingerprint of a packed object."""
    sample = sample_from_json((work / name / SAMPLE).read_bytes())
    return sample, Fingerprint(
        id=sample.id,
        category=sample.category,
        joints=tuple(one.joint.type for one in sample.joints),
        extents=sample.extents,
        geometry=sample.geometry,
        descriptor=(work / name / DESCRIPTOR).read_bytes(),
    )


def _keep_shared(path: Path, data: bytes) -> None:
    """Writes a shared file unless it exists; atomic across processes."""
    if path.is_file():
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    scratch = path.with_name(f".{path.name}.{os.getpid()}")
    scratch.write_bytes(data)
    scratch.replace(path)


def describe_object(
    job: ObjectJob,
    package: "SimPackage",
    report: "Report | None",
    files: dict[str, bytes],
    packed: PackedFiles,
) -> Sample:
    """Description of an object in the data set."""
    import numpy as np

    from sim_export.fingerprint import hash_geometry
    from sim_export.package import SourceMesh
    from sim_export.topology import find_topology

    provenance = dict(package.provenance)
    parts = {visual.part: visual.label for link in package.links for visual in link.visuals}
    labels = list(parts.values())
    corners = np.concatenate([hull.vertices for link in package.links for hull in link.hulls])
    verdicts = () if report is None else report.checks
    return Sample(
        id=job.key,
        category=package.category,
        source="grammar" if isinstance(job.inner, ShapeJob) else "model",
        seed=job.inner.seed,
        style=provenance.get("style", ""),
        generator=provenance["generator"],
        model=provenance.get("model", ""),
        draws=len(json.loads(provenance.get("draws", "[0]"))),
        topology=find_topology(package),
        extents=_vector(corners.max(axis=0) - corners.min(axis=0)),
        mass=round(sum(link.inertial.mass for link in package.links if link.inertial is not None), 4),
        counts=tuple(Count(label=label, count=labels.count(label)) for label in get_args(PartLabel)),
        joints=_joints(package),
        handles=_handles(package),
        links=len(package.links),
        hulls=sum(len(link.hulls) for link in package.links),
        triangles=sum(
            0 if isinstance(visual.mesh, SourceMesh) else len(visual.mesh.faces)
            for link in package.links
            for visual in link.visuals
        ),
        passed=None if report is None else report.passed,
        checks_passed=sum(check.verdict == "pass" for check in verdicts),
        checks_failed=tuple(check.id for check in verdicts if check.verdict == "fail"),
        checks_not_applicable=tuple(check.id for check in verdicts if check.verdict == "not_applicable"),
        geometry=hash_geometry(package),
        package=digest(files[LISTING]),
        files=len(files),
        unpacked_bytes=sum(len(data) for data in files.values()),
        shared=packed.shared,
        listed=packed.listed,
    )


def _joints(package: "SimPackage") -> tuple[DrivenJoint, ...]:
    import numpy as np

    from sim_export.motion.kinematics import object_joints

    label = {link.name: link.label for link in package.links}
    needs = {need.joint: need for need in package.requires_open}
    numbers = ("lower", "upper", "pitch", "friction", "damping")
    return tuple(
        DrivenJoint(
            joint=replace(
                joint,
                origin=np.array(_vector(joint.origin)),
                axis=np.array(_vector(joint.axis)),
                **{name: round(float(getattr(joint, name)), 6) for name in numbers},
            ),
            label=label[joint.child] or "",
            needs=needs[joint.name].needs if joint.name in needs else "",
            needs_fraction=float(needs[joint.name].fraction) if joint.name in needs else 0.0,
        )
        for joint in object_joints(package.joints)
    )


def _handles(package: "SimPackage") -> tuple[SampleHandle, ...]:
    return tuple(
        SampleHandle(
            link=handle.link,
            part=handle.part,
            gapart=handle.gapart,
            center=_vector(handle.corners.mean(axis=0)),
            normal=_vector(handle.normal),
            grasp_from=_vector(handle.grasp_line[0]),
            grasp_to=_vector(handle.grasp_line[1]),
            width=round(float(handle.width), 6),
            clearance=round(float(handle.clearance), 6),
            opening_direction=_vector(handle.opening_direction),
        )
        for handle in package.handles
    )


def _vector(values: object) -> Vector:
    x, y, z = (round(float(value), 6) + 0.0 for value in values)  # type: ignore[attr-defined]
    return x, y, z
