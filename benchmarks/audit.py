"""Audits articulated assets in folders of packages by the definitions of a published protocol.

    python benchmarks/audit.py FOLDER... [--workers 2]

The definitions are those of Arti-skill's "10K Sim-Ready URDF Dataset: Automatic Evaluation Protocol" as its
text gives them; its code was not used. What fails, or cannot be read, stays in the denominator. Two things
are ours, since the text says nothing of them: links penetrate from `DEEP` on, and a joint without limits
whose follower has limits (a screw) goes only as far as these let it. A drawer behind a door fails strict
collision by design, so it is counted both ways: as defined, and with what `requires_open` names opened first.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import tyro
from jaxtyping import Float
from numpy.typing import ArrayLike

from artigen.files.urdf import UrdfJoint, tree_problems
from artigen.types import Joint
from sim_export.checks.subject import Subject
from sim_export.checks.sweep import open_positions
from sim_export.files.folders import find_packages
from sim_export.geometry.contacts import penetration_depths

STATES = 21
"""States of each joint."""
SOBOL = 64
"""States of all joints together."""
DEEP = 1e-3
"""Metres from which two links penetrate."""
COLUMNS = (
    "strict URDF",
    "inertia valid",
    "portable limits",
    "joint dynamics",
    "kinematics",
    "strict collision",
    "strict collision, needs open",
)


@dataclass(frozen=True, kw_only=True)
class Audit:
    """What one asset passed, why it failed what it failed, and its deepest penetration in diagonals."""

    folder: Path
    faults: dict[str, str]
    """The first fault of each column that failed."""
    depth: float
    """Deepest penetration of links that are not parent and child, as a share of the diagonal."""


def audit_package(folder: Path) -> Audit:
    """All columns of one asset; an error of any kind is a fault."""
    subject = Subject(folder)
    depths = {False: 0.0, True: 0.0}

    def collide(*, opened: bool) -> str:
        depths[opened], where = _deepest(subject, opened=opened)
        return f"{where}: {1e3 * depths[opened]:.1f} mm" if depths[opened] > DEEP else ""

    tests: tuple[Callable[[], str], ...] = (
        lambda: _strict_urdf(subject),
        lambda: _inertia(subject),
        lambda: _limits(subject),
        lambda: _dynamics(subject),
        lambda: _kinematics(subject),
        lambda: collide(opened=False),
        lambda: collide(opened=True),
    )
    faults = {}
    for column, test in zip(COLUMNS, tests, strict=True):
        try:
            fault = test()
        except Exception as error:  # whatever breaks a reader is the asset's fault here
            fault = f"{type(error).__name__}: {error}"
        if fault:
            faults[column] = fault
    share = depths[False] / subject.diagonal if depths[False] else 0.0
    return Audit(folder=folder, faults=faults, depth=share)


def _strict_urdf(subject: Subject) -> str:
    import yourdfpy

    robot = yourdfpy.URDF.load(str(subject.folder / "mobility.urdf"), load_collision_meshes=True)
    if not robot.validate() or not robot.validate_filenames():
        return f"yourdfpy: {robot.errors}"
    problems = tree_problems(subject.urdf)
    if problems:
        return problems[0][1]
    for link in subject.urdf.links:
        if not link.collisions:
            return f"link {link.name} has no collision"
        if link.inertial is None:
            return f"link {link.name} has no inertia"
    for shape in (*subject.visuals, *subject.collisions):
        if not len(shape.faces) or not np.isfinite(shape.vertices).all():
            return f"{shape.file} has no faces, or numbers that are not finite"
    bad = next((fault for joint in subject.urdf.joints if (fault := _joint_fault(joint))), "")
    return bad or _inertia(subject)


def _joint_fault(joint: UrdfJoint) -> str:
    if joint.type == "fixed":
        return ""
    if not np.linalg.norm(joint.axis) > 0 or not np.isfinite(joint.T_parent_joint).all():
        return f"joint {joint.name}: axis {joint.axis.tolist()}"
    bounded = joint.type in ("revolute", "prismatic")
    if bounded and not (joint.lower is not None and joint.upper is not None and joint.lower < joint.upper):
        return f"joint {joint.name}: limits {joint.lower} to {joint.upper}"
    if joint.type == "continuous" and (joint.lower or 0.0) < (joint.upper or 0.0):
        return f"joint {joint.name}: a continuous joint with a range"
    return ""


def _inertia(subject: Subject) -> str:
    for link in subject.urdf.links:
        if link.inertial is None:
            return f"link {link.name} has no inertia"
        moments = np.linalg.eigvalsh(link.inertial.inertia)
        if not (link.inertial.mass > 0 and moments[0] > 0 and moments[2] <= moments[0] + moments[1]):
            return f"link {link.name}: mass {link.inertial.mass}, moments {moments.tolist()}"
    return ""


def _movable(subject: Subject) -> list[UrdfJoint]:
    return [joint for joint in subject.urdf.joints if joint.type != "fixed"]


def _limits(subject: Subject) -> str:
    for joint in _movable(subject):
        if joint.effort is None or joint.velocity is None or not (joint.effort >= 0 and joint.velocity > 0):
            return f"joint {joint.name}: effort {joint.effort}, velocity {joint.velocity}"
        if _joint_fault(joint):
            return _joint_fault(joint)
    return ""


def _dynamics(subject: Subject) -> str:
    for joint in _movable(subject):
        if joint.friction is None or joint.damping is None:
            return f"joint {joint.name}: friction {joint.friction}, damping {joint.damping}"
    return ""


def _kinematics(subject: Subject) -> str:
    """Every joint moves its descendants, finitely and rigidly, moves nothing else, and comes back."""
    for joint in subject.driven:
        T = subject.displacements({joint.name: _states(subject, joint)})
        inside = subject.carried(joint.child)
        for name, moved in T.items():
            moved = np.broadcast_to(moved, (STATES, 4, 4))
            rigid = np.abs(np.linalg.det(moved[:, :3, :3]) - 1.0).max() < 1e-9
            travel = float(np.abs(moved - np.eye(4)).max())
            followers = any(other.follows == joint.name for other in subject.joints)
            if not rigid or not np.isfinite(moved).all():
                return f"joint {joint.name}: link {name} is moved to no pose"
            if name not in inside and not followers and travel > 0:
                return f"joint {joint.name} moves {name}"
        child = np.broadcast_to(T[joint.child], (STATES, 4, 4))
        if not np.abs(child - np.eye(4)).max() > 1e-9:
            return f"joint {joint.name} moves nothing"
    return ""


def _states(subject: Subject, joint: Joint) -> Float[np.ndarray, "S"]:
    if joint.type != "continuous":
        return np.linspace(joint.lower, joint.upper, STATES)
    for follower in subject.joints:
        if follower.follows == joint.name and follower.ratio:
            return np.linspace(follower.lower, follower.upper, STATES) / follower.ratio
    return np.linspace(-np.pi, np.pi, STATES)


def _deepest(subject: Subject, *, opened: bool) -> tuple[float, str]:
    """The deepest penetration of links that are not parent and child, and where, over all states."""
    joined = {frozenset((joint.parent, joint.child)) for joint in subject.joints}
    pairs = [
        (first, second)
        for first, second in combinations([n for n, hulls in subject.hull_sets.items() if hulls.hulls], 2)
        if frozenset((first, second)) not in joined
    ]
    worst, where = 0.0, ""
    for name, qpos in _all_states(subject, opened=opened):
        T = subject.displacements(qpos)
        for first, second in pairs:
            still = all(T[link].ndim == 2 or np.ptp(T[link], axis=0).max() == 0 for link in (first, second))
            if still and name != "rest" and not opened:
                continue  # measured at rest
            depth = float(
                penetration_depths(
                    subject.hull_sets[first], subject.hull_sets[second], T[first], T[second]
                ).max()
            )
            if depth > worst:
                worst, where = depth, f"{name}: {first} in {second}"
    return worst, where


def _all_states(subject: Subject, *, opened: bool) -> list[tuple[str, dict[str, ArrayLike]]]:
    """Rest, every joint alone, all joints together; ``opened``: with what must be open first open enough."""
    from scipy.stats.qmc import Sobol

    states: list[tuple[str, dict[str, ArrayLike]]] = [("rest", {})]
    for joint in subject.driven:
        needs = open_positions(subject, joint) if opened else {}
        states.append((joint.name, {**needs, joint.name: _states(subject, joint)}))
    if len(subject.driven) > 1:
        lower = np.array([_states(subject, joint)[0] for joint in subject.driven])
        upper = np.array([_states(subject, joint)[-1] for joint in subject.driven])
        values = lower + Sobol(len(lower), scramble=False).random(SOBOL) * (upper - lower)
        qpos = {joint.name: values[:, index].copy() for index, joint in enumerate(subject.driven)}
        if opened:
            for joint in subject.driven:  # each is open already where another one needs it
                for name, least in open_positions(subject, joint).items():
                    qpos[name] = np.maximum(qpos[name], np.asarray(least, dtype=float))
        states.append(("all joints", dict(qpos)))
    return states


def main(folders: tyro.conf.Positional[tuple[Path, ...]], workers: int = 2) -> None:
    """Prints the table, and the first faults of each column.

    Args:
        folders: packages, or folders that hold some at any depth.
        workers: processes.
    """
    packages = find_packages(folders)
    with get_context("spawn").Pool(workers) as pool:
        audits = pool.map(audit_package, packages, chunksize=4)
    print(f"{len(audits)} assets, failures in the denominator\n")
    print(f"| {' | '.join(COLUMNS)} | deepest penetration |\n|{'---|' * (len(COLUMNS) + 1)}")
    passed = [100 * np.mean([column not in audit.faults for audit in audits]) for column in COLUMNS]
    print(f"| {' | '.join(f'{share:.1f} %' for share in passed)} | {max(a.depth for a in audits):.3f} |")
    for column in COLUMNS:
        failed = [audit for audit in audits if column in audit.faults]
        for audit in failed[:5]:
            print(f"{column}: {audit.folder.name}: {audit.faults[column]}")
        if len(failed) > 5:
            print(f"{column}: {len(failed) - 5} more")


if __name__ == "__main__":
    tyro.cli(main)
