"""Samples: the record of one object in a data set, as ``key.json`` in its shard and a row of the manifest."""

import json
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from artigen.datasets.packing import PackingError, SharedFile
from artigen.types import Joint, JointType

FORMAT = "artigen-sample"
VERSION = 1
Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Count:
    """Number of parts of a label."""

    label: str
    count: int


@dataclass(frozen=True, kw_only=True)
class DrivenJoint:
    """A joint that can be driven, and what must be open before it."""

    joint: Joint
    """SI units, object frame at rest."""
    label: str
    """Label of the part that it moves."""
    needs: str
    """Joint that must be open first; empty if there is none."""
    needs_fraction: float
    """Share of its range by which that joint must be open."""


@dataclass(frozen=True, kw_only=True)
class SampleHandle:
    """A place to grasp; metres, object frame at rest. ``annotations.json`` also has its box."""

    link: str
    part: str
    gapart: str
    center: Vector
    normal: Vector
    grasp_from: Vector
    grasp_to: Vector
    width: float
    clearance: float
    opening_direction: Vector


@dataclass(frozen=True, kw_only=True)
class Sample:
    """The record of one object."""

    id: str
    category: str
    source: str
    """``grammar`` or ``model``."""
    seed: int
    style: str
    generator: str
    """Program and version that made it."""
    model: str
    """Hash of the weights that drew it; empty for objects of the grammar."""
    draws: int
    """Number of draws until it passed."""
    topology: str
    """Equal for objects that can share one batch of an engine."""
    extents: Vector
    """Metres along x (depth), y (width), z (height) of the closed object."""
    mass: float
    """Kilograms."""
    counts: tuple[Count, ...]
    joints: tuple[DrivenJoint, ...]
    handles: tuple[SampleHandle, ...]
    links: int
    hulls: int
    triangles: int
    """Number of triangles of all visual meshes."""
    passed: bool | None
    """Whether every applicable check passed; None if the object was not checked."""
    checks_passed: int
    checks_failed: tuple[str, ...]
    """Ids of failed checks."""
    checks_not_applicable: tuple[str, ...]
    """Ids of checks that do not apply."""
    geometry: str
    """SHA-256 of the geometry."""
    package: str
    """SHA-256 of the package's listing ``manifest.json``."""
    files: int
    """Number of files of the package."""
    unpacked_bytes: int
    shared: tuple[SharedFile, ...]
    listed: bool
    """Whether the package's ``manifest.json`` follows from its other files and is not in the archive."""


def sample_json(sample: Sample) -> bytes:
    """A sample as compact JSON."""
    value = {"format": FORMAT, "version": VERSION} | asdict(sample)
    value["joints"] = [_list_joint(one) for one in sample.joints]
    return json.dumps(value, separators=(",", ":"), allow_nan=False).encode()


def sample_from_json(data: bytes) -> Sample:
    """Reads what `sample_json` wrote.

    Raises:
        PackingError: If the data have another form or version.
    """
    try:
        value: dict[str, Any] = json.loads(data)
        form, version = value.pop("format"), value.pop("version")
        if (form, version) != (FORMAT, VERSION):
            raise PackingError(f"a sample of format {form} {version}, this reads {FORMAT} {VERSION}")
        lists = {
            "counts": tuple(Count(**one) for one in value["counts"]),
            "joints": tuple(_read_joint(**one) for one in value["joints"]),
            "handles": tuple(SampleHandle(**_tuples(one)) for one in value["handles"]),
            "shared": tuple(SharedFile(**one) for one in value["shared"]),
        }
        return Sample(**(_tuples(value) | lists))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise PackingError(f"a sample's JSON is not as written by artigen ({error!r})") from error


def _list_joint(driven: DrivenJoint) -> dict[str, Any]:
    joint = driven.joint
    return {
        "name": joint.name, "kind": joint.type, "parent": joint.parent, "child": joint.child,
        "label": driven.label, "origin": joint.origin.tolist(), "axis": joint.axis.tolist(),
        "lower": joint.lower, "upper": joint.upper, "friction": joint.friction, "damping": joint.damping,
        "needs": driven.needs, "needs_fraction": driven.needs_fraction,
    } | ({"pitch": joint.pitch} if joint.pitch != 0.0 else {})  # fmt: skip


def _read_joint(
    *,
    kind: JointType,
    origin: list[float],
    axis: list[float],
    label: str,
    needs: str,
    needs_fraction: float,
    **own: Any,
) -> DrivenJoint:
    joint = Joint(type=kind, origin=np.array(origin), axis=np.array(axis), **own)
    return DrivenJoint(joint=joint, label=label, needs=needs, needs_fraction=needs_fraction)


def _tuples(value: dict[str, Any]) -> dict[str, Any]:
    return {key: tuple(one) if isinstance(one, list) else one for key, one in value.items()}
