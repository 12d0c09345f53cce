"""How the hulls of an object are made anew while its package fails checks of collision."""

from dataclasses import dataclass, replace
from typing import Literal

from sim_export.checks.draft import read_draft
from sim_export.checks.suite import run_checks
from sim_export.package import SimPackage

COLLISION_CHECKS = ("V006", "V102", "V103", "V104", "V105", "V107", "V201", "V202")
"""Static checks whose result depends on the choice of hulls."""


@dataclass(frozen=True, kw_only=True)
class HullWay:
    """How hulls are made: from the triangles of a source or from the meshes of voxels, with smaller ones for
    the links in ``finer``, which are the usual ones ``divided`` or other ones, ``fewer`` in all, and whether
    clearance cuts the hull that loses the smaller share, which spares thin leaves."""

    collision: Literal["surfaces", "voxels"] = "surfaces"
    finer: frozenset[str] = frozenset()
    divided: bool = False
    fewer: bool = False
    shares: bool = False


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """Collision checks that a package fails, the links that they name, these with those that a joint connects
    to them, and the value of V103."""

    failed: tuple[str, ...]
    links: frozenset[str]
    around: frozenset[str]
    unlike: float


def change_hulls(way: HullWay, judged: Judgement | None) -> HullWay | None:
    """How to make hulls after those made in one way were judged; None if nothing is to be gained.

    An object that ends up with too many hulls gets fewer, in each way. Links that failed checks name get
    smaller hulls, then those that a joint connects to them do: what is coarse takes more off its neighbours.
    Where this was not enough, or where links only meet each other on their way, clearance spares thin leaves.
    Then the usual ones are divided. After the triangles of a source come its voxels, which are closed where
    these are open, in the same ways.
    """
    if judged is not None and not judged.failed:
        return None
    if judged is not None and "V006" in judged.failed and not way.fewer:
        return replace(way, fewer=True)
    way = replace(way, fewer=False)
    if judged is not None and way.finer and way.shares and not way.divided:
        return replace(way, divided=True, shares=False)
    if judged is None or (way.shares and way.finer):
        return HullWay(collision="voxels") if way.collision == "surfaces" else None
    if not way.finer and not way.shares and {"V201", "V202"} >= set(judged.failed):
        return replace(way, shares=True)
    if not way.finer and not way.shares:
        return replace(way, finer=judged.links)
    more = way.finer | judged.around
    return replace(way, finer=more, shares=way.shares or more == way.finer)


def judge_package(package: SimPackage) -> Judgement:
    """Checks the collision of a package."""
    results = run_checks(read_draft(package), only=COLLISION_CHECKS)
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
