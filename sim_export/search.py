"""Search for the hulls of an object: links whose package fails checks get other ones while time lasts.

Best first: of all packages judged so far, the one that fails fewest checks, and these by least, is refined
next. A search can stop after any package; the best one so far is its result.
"""

import heapq
import logging
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Generic, Literal, TypeVar

from artigen.files.wavefront import ObjText
from artigen.runtime.budget import Budget
from sim_export.checks.draft import read_draft
from sim_export.checks.suite import run_checks
from sim_export.collision.cover.surface_hulls import LEVELS
from sim_export.errors import ExportError
from sim_export.package import SimPackage

logger = logging.getLogger(__name__)

COLLISION_CHECKS = ("V006", "V102", "V103", "V104", "V105", "V107", "V201", "V202")
"""Static checks whose result depends on the choice of hulls."""
MEETING = {"V201", "V202"}
"""Those that fail where links meet."""

Collision = Literal["auto", "exact", "coacd", "vhacd"]
"""Who makes hulls: our search; the boxes and cylinders that a source consists of; CoACD; V-HACD."""
Made = TypeVar("Made")


@dataclass(frozen=True, kw_only=True)
class HullPlan:
    """How hulls are made.

    ``target`` is what they cover: the triangles of a source, or the meshes of voxels, which are closed where
    these are open. A ``method`` other than ``auto`` makes them of the triangles, with ``options`` if it is
    CoACD, and is not refined. ``levels`` tells which of `LEVELS` a link has if not the usual one. ``fewer``:
    in all. ``shares``: clearance cuts the hull that loses the smaller share, which spares thin leaves.
    """

    target: Literal["surfaces", "voxels"] = "surfaces"
    method: Collision = "auto"
    options: tuple[tuple[str, float | int | bool | str], ...] = ()
    levels: frozenset[tuple[str, int]] = frozenset()
    fewer: bool = False
    shares: bool = False


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """Collision checks that a package fails, the links that fail them, these with those that a joint connects
    to them, and the value of V103."""

    failed: tuple[str, ...]
    links: frozenset[str]
    around: frozenset[str]
    unlike: float

    @property
    def rank(self) -> tuple[int, float]:
        """Less is better."""
        return len(self.failed), self.unlike


@dataclass(frozen=True, kw_only=True, eq=False)
class Found(Generic[Made]):
    """The best of what a search made, its judgement, how many were made, and the errors of plans that could
    not be carried out."""

    best: Made
    judged: Judgement
    made: int
    errors: tuple[ExportError, ...]


def search_hulls(
    first: HullPlan,
    make: Callable[[HullPlan], Made],
    judge: Callable[[Made], Judgement],
    budget: Budget,
) -> Found[Made]:
    """The best object that plans lead to until one passes, none is left, or the budget ends.

    One object is made in any case.

    Raises:
        ExportError: That of the first plan, if no plan can be carried out.
    """
    queue: list[tuple[tuple[int, float], int, HullPlan, Judgement | None]] = [((0, 0.0), 0, first, None)]
    known, best, errors, made = {first}, None, list[ExportError](), 0
    while queue and (best is None or not budget.is_over()):
        rank, _, plan, before = heapq.heappop(queue)
        try:
            one = make(plan)
        except ExportError as error:
            errors.append(error)
            judged = None
        else:
            made, judged = made + 1, judge(one)
            rank = judged.rank
            logger.info("%s: V103 is %.3g of the allowed, fails: %s", plan, judged.unlike, judged.failed)
            if best is None or rank < best[1].rank:
                best = one, judged
            if not judged.failed:
                break
            if judged == before:  # the plan has changed nothing, so what follows from it would not either
                continue
        for following in refine_plan(plan, judged):
            if following not in known:
                known.add(following)
                heapq.heappush(queue, (rank, len(known), following, judged))
    if best is None:
        raise errors[0]
    return Found(best=best[0], judged=best[1], made=made, errors=tuple(errors))


def refine_plan(plan: HullPlan, judged: Judgement | None) -> Iterator[HullPlan]:
    """Plans to follow one whose result was judged, the most promising first; None: it could not be carried
    out.

    Too many hulls become fewer before anything else. Links that meet are cut otherwise before they get
    smaller hulls; links that fail get smaller hulls, and then those that a joint connects to them do: what is
    coarse takes more off its neighbours. Beside the triangles of a source come its voxels.
    """
    if plan.method != "auto":
        return
    closed = [HullPlan(target="voxels")] if plan.target == "surfaces" else []
    if judged is None:
        yield from closed
        return
    if "V006" in judged.failed and not plan.fewer:
        yield replace(plan, fewer=True)
    plan = replace(plan, fewer=False)
    other = replace(plan, shares=not plan.shares)
    if set(judged.failed) <= MEETING:
        yield other
    smaller = _refine(plan, judged.links)
    yield from (*closed, smaller) if "V006" in judged.failed else (smaller, *closed)
    yield _refine(plan, judged.around)
    yield other


def _refine(plan: HullPlan, links: frozenset[str]) -> HullPlan:
    """A plan with the next level for some links; the last one stays."""
    levels: Mapping[str, int] = dict(plan.levels)
    finer = {name: min(levels.get(name, 0) + 1, len(LEVELS) - 1) for name in links}
    return replace(plan, levels=frozenset({**levels, **finer}.items()))


def judge_package(package: SimPackage, known: dict[Path, ObjText] | None = None) -> Judgement:
    """Checks the collision of a package; ``known`` as in `read_draft`."""
    results = run_checks(read_draft(package, known), only=COLLISION_CHECKS)
    unlike = [check.value for check in results if check.id == "V103" and check.value is not None]
    failed = [check for check in results if check.verdict == "fail"]
    named = {link for check in failed for link in check.links} or {link.name for link in package.links}
    between = {link.name for link in package.links if not link.parts}  # of screws
    links = named
    for _ in range(2):
        ends = [{joint.parent, joint.child} for joint in package.joints]
        links = links.union(*(pair for pair in ends if pair & (named | (links & between))))
    return Judgement(
        failed=tuple(check.id for check in failed),
        links=frozenset(named - between),
        around=frozenset(links - between),
        unlike=max(unlike, default=0.0),
    )
