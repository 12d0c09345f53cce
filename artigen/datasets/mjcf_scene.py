"""Tells the objects of an MJCF from the scene around them: floors, walls, tables and loose things.

Objects are the bodies of the world that carry something on hinges, slides or balls; without any, those that
lie freely. Where joints hang from the world itself, the world is an object, without what is called like
scenery (`SCENERY`).
"""

# mujoco is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from artigen.datasets.mjcf_geoms import is_seen
from artigen.errors import SourceError, list_some

if TYPE_CHECKING:
    import mujoco

SCENERY = frozenset(("floor", "ground", "wall", "walls", "ceiling", "room", "table", "tabletop", "arena"))
"""Words in names of bodies and geoms that are around an object."""


@dataclass(frozen=True, kw_only=True)
class Choice:
    """The bodies of one object, the root first and parents before children, its geoms, and what was left out
    around it."""

    bodies: tuple[int, ...]
    geoms: tuple[int, ...]
    notes: tuple[str, ...]


def list_roots(model: "mujoco.MjModel") -> list[int]:
    """Bodies that are the roots of objects; the world (0) is one if something drawn is fixed to it from which
    other things hang."""
    weld, top = np.asarray(model.body_weldid), np.asarray(model.body_rootid)
    seen = [geom for geom in range(model.ngeom) if is_seen(model, geom)]
    owners = np.unique(np.asarray(model.geom_bodyid)[seen])
    tops = [body for body in range(1, model.nbody) if model.body_parentid[body] == 0]
    moved = {body for body in range(1, model.nbody) if _moves(model, body)}
    hinged = [body for body in tops if body in moved]
    stirred = {int(top[body]) for body in moved}
    moving = [body for body in tops if body not in moved and body in stirred]
    bearing = {int(top[owner]) for owner in owners if weld[owner] == weld[top[owner]]}
    carriers = {body for body in moving if body in bearing}
    framed = any(weld[owner] == 0 and int(top[owner]) not in carriers for owner in owners)
    if framed and len(hinged) + len(moving) > len(carriers):
        return [0, *sorted(carriers)]
    seen_on, shown = set(owners.tolist()), set(top[owners].tolist())
    loose = [body for body in tops if model.body_jntnum[body] and body in seen_on]
    drawn = [body for body in tops if body in shown]
    alone = drawn if len(drawn) == 1 and 0 not in owners else [0]
    return sorted([*hinged, *moving]) or loose or alone


def name_root(model: "mujoco.MjModel", body: int) -> str:
    """Name of a body, or its number."""
    return model.body(body).name or f"body_{body}"


def choose_object(model: "mujoco.MjModel", path: Path, body: str | None) -> Choice:
    """The bodies and geoms of one object.

    Raises:
        SourceError: If there is no such body, or none is requested and there are several objects.
    """
    roots = list_roots(model)
    names = [name_root(model, index) for index in range(model.nbody)]
    if body is None and len(roots) > 1:
        raise SourceError(
            f"{path}: holds {len(roots)} objects ({list_some(names[root] for root in roots)}), expected one: "
            "choose it with --body NAME"
        )
    if body is not None and body not in names:
        raise SourceError(f"{path}: has no body {body!r}, expected one of {list_some(names)}")
    root = roots[0] if body is None else names.index(body)
    below = {root}
    for index in range(root + 1, model.nbody):
        if int(model.body_parentid[index]) in below:
            below.add(index)
    if root == 0:
        below = _leave_scenery(model, below, roots, names)
    owners = np.asarray(model.geom_bodyid)
    geoms = np.flatnonzero(np.isin(owners, sorted(below)))
    called = np.array([not owners[g] and _is_scenery(model.geom(g).name) for g in geoms], dtype=bool)
    if root == 0 and not called.all():
        geoms = geoms[~called]
    tops = [index for index in range(1, model.nbody) if model.body_parentid[index] == 0]
    left = [names[index] for index in tops if index not in below]
    bare = int(np.sum(owners == 0)) - int(np.sum(owners[geoms] == 0))
    left += [f"geoms of the world ({bare})"] if bare else []
    notes = [f"around {names[root]!r} in the file, left out: {list_some(left)}"] if left else []
    return Choice(bodies=tuple(sorted(below)), geoms=tuple(geoms.tolist()), notes=tuple(notes))


def _moves(model: "mujoco.MjModel", body: int) -> bool:
    """Whether a body has joints other than a free one."""
    import mujoco

    first = int(model.body_jntadr[body])
    kinds = np.asarray(model.jnt_type)[first : first + int(model.body_jntnum[body])] if first >= 0 else ()
    return any(int(kind) != int(mujoco.mjtJoint.mjJNT_FREE) for kind in kinds)


def _leave_scenery(
    model: "mujoco.MjModel", below: set[int], roots: Sequence[int], names: Sequence[str]
) -> set[int]:
    """The bodies of the world without other objects, loose things, and still ones called like scenery, unless
    nothing else is still."""
    top, owners = np.asarray(model.body_rootid), np.asarray(model.geom_bodyid)
    moving = {int(top[index]) for index in below if _moves(model, index)}
    still = {int(one) for one in top if int(one) not in (0, *roots, *moving) and not model.body_jntnum[one]}
    called = {one for one in still if _is_scenery(names[one])}
    called = called if (still - called) or 0 in owners else set()
    kept = {0, *moving, *(still - called)} - (set(roots) - {0})
    return {index for index in below if int(top[index]) in kept}


def _is_scenery(name: str) -> bool:
    words = re.findall(r"[a-z]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower())
    return not SCENERY.isdisjoint(words)
