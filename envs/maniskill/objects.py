"""What a task knows of a package before any simulator runs: the parts it may use, and where to hold them.

A drawer or door is usable if one joint with limits moves it. Everything else that moves is left out by
name, with the reason, instead of turning into a NaN later.
"""

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from sim_export.files.read import read_package
from sim_export.package import HandleAnnotation, Hull, PackageJoint, SimPackage
from sim_export.tree import hanging_links, needed_fractions

from .folders import TaskError, demand_validation, find_packages

PartKind = Literal["drawer", "door", "any"]
Validation = Literal["passed", "any"]
HandleNeed = Literal["required", "optional"]
HANDLE_SLACK = 0.005
"""How far hulls of a handle may reach out of its box, metres."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TaskPart:
    """A part that a task may move.

    ``grip`` is where a gripper takes hold (object frame at rest, metres): the middle of ``handle``, or
    of the free edge of the part where no handle is annotated. ``moved`` are the part's hull vertices in the
    same frame, with those of everything it carries; ``held`` are the hulls that make up the handle;
    ``needs`` are joints that must stand open first.
    """

    kind: Literal["drawer", "door"]
    joint: PackageJoint
    handle: HandleAnnotation | None
    grip: Float[np.ndarray, "3"]
    moved: Float[np.ndarray, "V 3"]
    held: tuple[Hull, ...]
    needs: tuple[str, ...]

    @property
    def span(self) -> float:
        """Length of the range, m or rad."""
        return self.joint.upper - self.joint.lower


@dataclass(frozen=True, kw_only=True, eq=False)
class TaskObject:
    """A package with its usable parts. ``left_out`` are (joint, reason); ``floor`` is the lowest z and
    ``bounds`` the box of all hulls at rest, metres."""

    folder: Path
    package: SimPackage
    parts: tuple[TaskPart, ...]
    left_out: tuple[tuple[str, str], ...]
    bounds: Float[np.ndarray, "2 3"]

    @property
    def floor(self) -> float:
        """Height of the object's lowest point in its own frame."""
        return float(self.bounds[0, 2])


def read_objects(
    packages: str | Path | Sequence[str | Path],
    kind: PartKind,
    *,
    joint: str | None = None,
    handles: HandleNeed = "optional",
    validation: Validation = "passed",
) -> tuple[TaskObject, ...]:
    """Every package that has a part of the kind asked for.

    Args:
        packages: as for `find_packages`.
        kind: ``drawer``, ``door``, or ``any`` of the two.
        joint: only parts on a joint of that name.
        handles: whether parts without an annotated handle are left out.
        validation: ``passed`` wants a passed ``validation.json`` in every package.

    Raises:
        TaskError: if there is no package, one of them failed its validation or never had one, or none
            has a part of the kind.
    """
    folders = find_packages(packages)
    if validation == "passed":
        demand_validation(folders)
    objects = [read_object(folder, kind, handles) for folder in folders]
    if joint is not None:
        objects = [_only(entry, joint) for entry in objects]
    usable = tuple(entry for entry in objects if entry.parts)
    if not usable:
        reasons = [f"{entry.package.name}: {_describe(entry)}" for entry in objects[:3]]
        more = f", and {len(objects) - 3} packages more" if len(objects) > 3 else ""
        wanted = "a drawer or door" if kind == "any" else f"a {kind}"
        with_handle = " with a handle" if handles == "required" else ""
        with_handle += "" if joint is None else f" on joint {joint!r}"
        raise TaskError(
            f"{len(objects)} packages and none has {wanted}{with_handle} on a joint with limits "
            f"({'; '.join(reasons)}{more}); ask for another part or give other packages"
        )
    return usable


@functools.lru_cache(maxsize=256)
def read_object(folder: Path, kind: PartKind, handles: HandleNeed = "optional") -> TaskObject:
    """One package with its usable parts, of which there may be none."""
    package = read_package(folder, appearance=False)
    labels = {link.name: link.label for link in package.links}
    followed = {joint.mimic for joint in package.joints if joint.mimic is not None}
    held = {handle.link: handle for handle in reversed(package.handles)}
    parts: list[TaskPart] = []
    left_out: list[tuple[str, str]] = []
    for joint in package.joints:
        if joint.type == "fixed":
            continue
        found = _kind_of(joint, labels.get(joint.child), followed)
        handle = _handle_of(package, joint.child, held)
        if found not in ("drawer", "door"):
            left_out.append((joint.name, found))
        elif kind not in ("any", found):
            left_out.append((joint.name, f"moves a {found}"))
        elif handle is None and handles == "required":
            left_out.append((joint.name, f"its {found} has no handle"))
        else:
            parts.append(_part(package, joint, "drawer" if found == "drawer" else "door", handle))
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
    """The object with the parts on other joints left out."""
    others = tuple((x.joint.name, "was not asked for") for x in entry.parts if x.joint.name != joint)
    parts = tuple(part for part in entry.parts if part.joint.name == joint)
    return replace(entry, parts=parts, left_out=entry.left_out + others)


def _describe(entry: TaskObject) -> str:
    return ", ".join(f"{name} {reason}" for name, reason in entry.left_out) or "no joint moves"


def _kind_of(joint: PackageJoint, label: str | None, followed: set[str]) -> str:
    """``drawer`` or ``door``, or why the joint cannot be used. Unlabelled parts go by their joint."""
    if joint.kind == "screw" or joint.mimic is not None or joint.name in followed:
        return "is part of a screw"
    if joint.type == "continuous":
        return "turns without limits"
    if not joint.upper - joint.lower > 0.0:
        return "has an empty range"
    if label in ("drawer", "door"):
        return label
    if label is None:
        return "drawer" if joint.type == "prismatic" else "door"
    return f"moves a {label}"


def _handle_of(package: SimPackage, link: str, held: dict[str, HandleAnnotation]) -> HandleAnnotation | None:
    """The handle on a link, or else the one on something the link carries: the knob of a safe's door."""
    if link in held:
        return held[link]
    for joint in package.joints:
        if joint.parent == link and (found := _handle_of(package, joint.child, held)) is not None:
            return found
    return None


def _part(
    package: SimPackage,
    joint: PackageJoint,
    kind: Literal["drawer", "door"],
    handle: HandleAnnotation | None,
) -> TaskPart:
    links = {link.name: link for link in package.links}
    names = hanging_links(package.joints, joint.child)
    hulls = [hull.vertices for link in package.links if link.name in names for hull in link.hulls]
    moved = np.concatenate([np.zeros((0, 3)), *hulls])
    if not len(moved):
        raise TaskError(f"package {package.name!r}: link {joint.child!r} has no collision shape to touch")
    return TaskPart(
        kind=kind,
        joint=joint,
        handle=handle,
        grip=handle.corners.mean(axis=0) if handle is not None else _edge_point(joint, moved),
        moved=moved,
        held=() if handle is None else _hulls_of_handle(links[handle.link].hulls, handle),
        needs=tuple(needed_fractions(joint.name, package.requires_open)),
    )


def _hulls_of_handle(hulls: tuple[Hull, ...], handle: HandleAnnotation) -> tuple[Hull, ...]:
    """The hulls that lie in the handle's box."""
    low, high = handle.corners.min(axis=0) - HANDLE_SLACK, handle.corners.max(axis=0) + HANDLE_SLACK
    return tuple(x for x in hulls if (x.vertices >= low).all() and (x.vertices <= high).all())


def _edge_point(joint: PackageJoint, moved: np.ndarray) -> np.ndarray:
    """Middle of a sliding part's leading face, or of a turning part's edge farthest from its axis."""
    if joint.type == "prismatic":
        reach = moved @ joint.axis
    else:
        arms = moved - joint.origin
        reach = np.linalg.norm(np.cross(joint.axis, arms), axis=1)
    edge = moved[reach > reach.max() - 0.01]
    return (edge.min(axis=0) + edge.max(axis=0)) / 2.0
