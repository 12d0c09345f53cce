"""Usable parts of a package and their grasp points, found without a simulator.

A part is usable if one joint moves it and nothing follows it. All other moving parts are listed by name with
the reason, instead of causing a NaN later.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.brief import Brief
from artigen.errors import ArtigenError
from artigen.kind import find_category
from artigen.types import Joint, PartLabel
from sim_export.errors import PackageError
from sim_export.files.folders import find_packages as package_folders
from sim_export.files.read import read_package
from sim_export.motion.kinematics import hanging_links, needed_fractions
from sim_export.package import HandleAnnotation, Hull, SimPackage
from sim_export.physics.phrases import name_parts
from sim_export.report import report_from_json

from ..folder_stamp import kept_until_written
from .verbs import VERBS, Verb, grip_direction, verb_of

PartKind = Literal["drawer", "door", "handle", "knob", "tray", "shelf", "any"]
Validation = Literal["passed", "any"]
HandleNeed = Literal["required", "optional"]
HANDLE_SLACK = 0.005
"""Distance by which hulls of a handle may extend beyond its box, metres."""
QUARTER = float(np.pi / 2.0)
"""Rotation of joints without limits in tasks, rad."""
LOW, PLINTH = 0.75, 0.5
"""Height below which objects stand on a plinth, and height of the plinth, metres: an arm needs room below."""
LATCH_LABELS = ("knob", "handle")
"""Labels of latches: a part with such a label that a leaf requires to be moved first. The robot operates
it."""
REPORT_FILE = "validation.json"


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class TaskPart(Brief):
    """A part that a task may move.

    ``kind`` is the part's label and ``verb`` the action on it. ``grip`` is the grasp point (object frame at
    rest, metres): the middle of ``handle``, or of the free edge of the part if no handle is annotated.
    ``moved`` are the hull vertices of the part and all it carries, in the same frame; ``own`` are the hulls
    of the part itself and ``held`` those of the handle. ``needs`` are joints that must be open first, and
    ``latches`` those of them that a hand operates, in order. A joint without limits has a range of a quarter
    turn here.
    """

    kind: PartLabel
    verb: Verb
    joint: Joint
    handle: HandleAnnotation | None
    grip: Float[np.ndarray, "3"]
    moved: Float[np.ndarray, "V 3"]
    own: tuple[Hull, ...]
    held: tuple[Hull, ...]
    needs: tuple[str, ...]
    latches: "tuple[Latching, ...]" = ()

    @property
    def span(self) -> float:
        """Length of the range, m or rad."""
        return self.joint.upper - self.joint.lower

    @property
    def grip_latch(self) -> "Latching | None":
        """The latch that is also this part's handle: a door's lever."""
        if self.handle is None:
            return None
        return next((x for x in self.latches if x.part.joint.child == self.handle.link), None)


@dataclass(frozen=True, kw_only=True, eq=False)
class Latching:
    """A latch, and the share of its range to which it must be open before the part it holds moves."""

    part: TaskPart
    fraction: float


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class TaskObject(Brief):
    """A package with its usable parts. ``left_out`` are (joint, reason), ``bounds`` is the box of all hulls
    at rest, and ``raised`` is the height of the plinth below the object, metres."""

    folder: Path
    package: SimPackage
    parts: tuple[TaskPart, ...]
    left_out: tuple[tuple[str, str], ...]
    bounds: Float[np.ndarray, "2 3"]
    raised: float = 0.0

    @property
    def floor(self) -> float:
        """Height of the ground in the object's own frame."""
        return float(self.bounds[0, 2]) - self.raised


def on_plinth(entry: TaskObject) -> TaskObject:
    """Places the object on a plinth if it is low, as on a counter or a wall."""
    height = float(entry.bounds[1, 2] - entry.bounds[0, 2])
    return replace(entry, raised=PLINTH if height < LOW else 0.0)


def read_objects(
    packages: str | Path | Sequence[str | Path],
    kind: PartKind,
    *,
    joint: str | None = None,
    handles: HandleNeed = "optional",
    validation: Validation = "passed",
    verb: Verb = "open",
) -> tuple[TaskObject, ...]:
    """All packages that have a part of the requested kind.

    Args:
        packages: As for `find_packages`.
        kind: ``drawer``, ``door`` or another label; ``any`` is every part that the verb applies to.
        joint: Only parts on a joint with this name.
        handles: Whether parts without an annotated handle are excluded.
        validation: ``passed`` requires a passed ``validation.json`` in every package.
        verb: ``open`` selects drawers and doors with any motion; other verbs select parts by their motion.

    Raises:
        ValueError: If the verb is unknown.
        TaskError: If there is no package, one of them failed validation or was not validated, or none has a
            part of the kind.
    """
    if verb not in VERBS:
        raise ValueError(f"verb {verb!r}, expected one of {', '.join(VERBS)}")
    folders = find_packages(packages)
    if validation == "passed":
        demand_validation(folders)
    objects = [read_object(folder, kind, handles, verb) for folder in folders]
    if joint is not None:
        objects = [_only(entry, joint) for entry in objects]
    usable = tuple(entry for entry in objects if entry.parts)
    if not usable:
        reasons = [f"{entry.package.name}: {_describe(entry)}" for entry in objects[:3]]
        more = f", and {len(objects) - 3} packages more" if len(objects) > 3 else ""
        wanted = f"a {kind}" if kind != "any" else "a drawer or door" if verb == "open" else "a part"
        wanted += "" if verb == "open" else f" to {verb}"
        with_handle = " with a handle" if handles == "required" else ""
        with_handle += "" if joint is None else f" on joint {joint!r}"
        raise TaskError(
            f"{len(objects)} packages and none has {wanted}{with_handle} "
            f"that one joint moves ({'; '.join(reasons)}{more}); ask for another part or give other packages"
        )
    return usable


def say_part(entry: TaskObject, part: TaskPart) -> str:
    """A phrase for a part with its article: "the top drawer of the dresser"."""
    category = find_category(entry.package.category)
    noun = next(iter(category.nouns), None) if category else None
    noun = noun or entry.package.category.lower() or "object"
    parts = {each.link: each for each in name_parts(entry.package, noun)}
    return f"the {parts[part.joint.child].phrases[-1]}"


@kept_until_written(256)
def read_object(
    folder: Path, kind: PartKind, handles: HandleNeed = "optional", verb: Verb = "open"
) -> TaskObject:
    """One package with its usable parts, possibly none; read again only after its files have changed."""
    package = read_package(folder, appearance=False)
    labels: dict[str, PartLabel | None] = {link.name: link.label for link in package.links}
    parts: list[TaskPart] = []
    left_out: list[tuple[str, str]] = []
    for joint in package.joints:
        if joint.type == "fixed":
            continue
        # An unlabelled part is a drawer or a door, depending on its joint.
        label = labels[joint.child] or ("drawer" if joint.type == "prismatic" else "door")
        reason = _unusable(joint, label)
        if not reason:
            part = _read_part(package, joint, label)
            reason = _unwanted(part, kind, handles, verb)
            parts += [] if reason else [part]
        if reason:
            left_out.append((joint.name, reason))
    corners = np.concatenate([np.zeros((0, 3)), *(hull.vertices for x in package.links for hull in x.hulls)])
    if not len(corners):
        raise TaskError(f"{folder}: no collision shape at all; nothing can touch it")
    return TaskObject(
        folder=folder,
        package=package,
        parts=tuple(parts),
        left_out=tuple(left_out),
        bounds=np.stack([corners.min(axis=0), corners.max(axis=0)]),
    )


def _only(entry: TaskObject, joint: str) -> TaskObject:
    """The object with only the parts on one joint."""
    others = tuple((x.joint.name, "was not asked for") for x in entry.parts if x.joint.name != joint)
    parts = tuple(part for part in entry.parts if part.joint.name == joint)
    return replace(entry, parts=parts, left_out=entry.left_out + others)


def _describe(entry: TaskObject) -> str:
    return ", ".join(f"{name} {reason}" for name, reason in entry.left_out) or "no joint moves"


def _unusable(joint: Joint, label: PartLabel) -> str:
    """Reason why a joint cannot be used, "" if it can."""
    if joint.kind == "screw":
        return "is part of a screw"
    if joint.follows is not None:
        return f"follows {joint.follows}"
    if joint.type == "continuous":
        return "" if label in LATCH_LABELS else "turns without limits"
    if not joint.upper - joint.lower > 0.0:
        return "has an empty range"
    return "moves a wheel" if label == "wheel" else ""


def _unwanted(part: TaskPart, kind: PartKind, handles: HandleNeed, verb: Verb) -> str:
    """Reason why a part does not match the request, "" if it does."""
    if kind not in ("any", part.kind) or (verb == "open" and part.kind not in ("drawer", "door")):
        return f"moves a {part.kind}"
    if verb not in ("open", part.verb):
        return f"is there to {part.verb}"
    if handles == "required" and part.handle is None:
        return f"its {part.kind} has no handle"
    return ""


def _handle_of(package: SimPackage, link: str, held: dict[str, HandleAnnotation]) -> HandleAnnotation | None:
    """The handle on a link, or else on a link that it carries: the knob of a safe's door."""
    if link in held:
        return held[link]
    carried = [joint for joint in package.joints if joint.parent == link]
    for joint in sorted(carried, key=lambda joint: joint.type == "prismatic"):  # prefer a lever over a bolt
        if (found := _handle_of(package, joint.child, held)) is not None:
            return found
    return None


def _read_part(package: SimPackage, joint: Joint, label: PartLabel) -> TaskPart:
    links = {link.name: link for link in package.links}
    names = hanging_links(package.joints, joint.child)
    hulls = [hull.vertices for link in package.links if link.name in names for hull in link.hulls]
    moved = np.concatenate([np.zeros((0, 3)), *hulls])
    if not len(moved):
        raise TaskError(f"package {package.name!r}: link {joint.child!r} has no collision shape to touch")
    if joint.type == "continuous":
        joint = replace(joint, lower=0.0, upper=QUARTER)
    handle = _handle_of(package, joint.child, {x.link: x for x in reversed(package.handles)})
    grip = _edge_point(joint, moved) if handle is None else handle.corners.mean(axis=0)
    normal = handle.normal if handle is not None else grip_direction(joint, grip)
    needs = needed_fractions(joint.name, package.requires_open)
    return TaskPart(
        kind=label,
        verb=verb_of(joint, label, grip, normal, moved if handle is None else handle.corners),
        joint=joint,
        handle=handle,
        grip=grip,
        moved=moved,
        own=links[joint.child].hulls,
        held=() if handle is None else _hulls_of_handle(links[handle.link].hulls, handle),
        needs=tuple(needs),
        latches=_read_latches(package, needs),
    )


def _read_latches(package: SimPackage, needs: dict[str, float]) -> tuple[Latching, ...]:
    """Required joints that move knobs and handles, each after its own requirements.

    Latches on another leaf that stands open hold nothing and are skipped.
    """
    labels = {link.name: link.label for link in package.links}
    leaves = [x for x in package.joints if x.name in needs and labels[x.child] not in LATCH_LABELS]
    gone = {name for joint in leaves for name in hanging_links(package.joints, joint.child)}
    found = [
        Latching(part=_read_part(package, joint, label), fraction=needs[joint.name])
        for joint in package.joints
        if joint.name in needs and joint.child not in gone and (label := labels[joint.child]) in LATCH_LABELS
    ]
    return tuple(sorted(found, key=lambda latch: len(latch.part.needs)))


def _hulls_of_handle(hulls: tuple[Hull, ...], handle: HandleAnnotation) -> tuple[Hull, ...]:
    """The hulls inside the handle's box."""
    low, high = handle.corners.min(axis=0) - HANDLE_SLACK, handle.corners.max(axis=0) + HANDLE_SLACK
    return tuple(x for x in hulls if (x.vertices >= low).all() and (x.vertices <= high).all())


def _edge_point(joint: Joint, moved: np.ndarray) -> np.ndarray:
    """Middle of a sliding part's leading face, or of a turning part's edge farthest from its axis."""
    if joint.type == "prismatic":
        reach = moved @ joint.axis
    else:
        arms = moved - joint.origin
        reach = np.linalg.norm(np.cross(joint.axis, arms), axis=1)
    edge = moved[reach > reach.max() - 0.01]
    return (edge.min(axis=0) + edge.max(axis=0)) / 2.0


class TaskError(ArtigenError):
    """A task cannot be built from these packages; the message states what was found and what is needed."""


def find_packages(packages: str | Path | Sequence[str | Path]) -> tuple[Path, ...]:
    """Package folders among the given folders or at any depth below them.

    Raises:
        TaskError: If a folder contains no package.
    """
    if not packages:
        raise TaskError("packages is an empty list; give a folder of packages")
    try:
        return package_folders(packages)
    except PackageError as error:
        raise TaskError(f"{error}; artigen convert, shape and export write packages") from error


def demand_validation(folders: Sequence[Path]) -> None:
    """Raises `TaskError` unless every package has a ``validation.json`` with a passed report."""
    missing = [folder for folder in folders if not (folder / REPORT_FILE).is_file()]
    if missing:
        raise TaskError(
            f"{len(missing)} of {len(folders)} packages have no {REPORT_FILE}, {missing[0]} is the first; "
            "run artigen validate on them, or pass validation='any' to use them as they are"
        )
    for folder in folders:
        report = report_from_json((folder / REPORT_FILE).read_text())
        if not report.passed:
            failed = ", ".join(f"{check.id} ({check.title})" for check in report.failures)
            raise TaskError(
                f"{folder}: the package failed validation: {failed}; repair it or take it out of the folder, "
                "or pass validation='any' to use it as it is"
            )
