"""L0: XML, tree, schema, paths, joints, counts, mass, inertia, size and the manifest (V001 to V010)."""

import posixpath
import re
from pathlib import PurePosixPath

import numpy as np

from artigen.files.urdf import UrdfInertial, UrdfJoint, UrdfLink, tree_problems
from artigen.kind import find_category
from artigen.types import FULL_TURN
from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, always, at_most, count_problems
from sim_export.checks.subject import MAIN_URDF, Subject
from sim_export.errors import PackageError
from sim_export.files.urdf import splats_path
from sim_export.files.write import MANIFEST, UNHASHED, manifest_problems
from sim_export.geometry.contacts import HullSet
from sim_export.package import URDF_JOINT_TYPES

SIDECARS = (
    "annotations.json",
    "bounding_box.json",
    "meta.json",
    "mobility_v2.json",
    "physics.json",
    "materials.json",
    "provenance.json",
    "semantics.txt",
)
PARTNET_SIDECARS = ("PROVENANCE.json", "result.json", "result_after_merging.json", "images/info.json")
_REFERENCES = {
    ".obj": re.compile(rb"^[ \t]*mtllib[ \t]+([^\r\n]+)", re.MULTILINE),
    ".mtl": re.compile(rb"^[ \t]*(?:map_\w+|bump|disp|decal|refl|norm)[ \t]+([^\r\n]+)", re.MULTILINE),
}
Problems = list[tuple[str, str]]


def check_tree(subject: Subject, cfg: CheckConfig) -> Finding:
    """V001: every URDF is well-formed and its links are one tree with unique names."""
    problems: Problems = []
    links = 0
    for name, urdf in subject.urdfs.items():
        if isinstance(urdf, PackageError):
            problems.append((name, str(urdf)))
            continue
        links = max(links, len(urdf.links))
        problems += [(where, f"{name}: {sentence}") for where, sentence in tree_problems(urdf)]
    return count_problems(problems, f"one tree of {links} links with unique names")


def check_schema(subject: Subject, cfg: CheckConfig) -> Finding:
    """V002: yourdfpy, an independent reader, parses the URDF completely and finds every mesh file."""
    from lxml.etree import LxmlError
    from yourdfpy import URDF

    assert subject.urdf.path.name == MAIN_URDF  # parsed safely before; yourdfpy would expand entities
    try:
        robot = URDF.load(
            str(subject.folder / MAIN_URDF),
            build_scene_graph=False,
            build_collision_scene_graph=False,
            load_meshes=False,
            load_collision_meshes=False,
        )
        complete = robot.validate()
    except (LxmlError, ValueError, KeyError, TypeError, AttributeError) as err:
        return count_problems([(MAIN_URDF, f"yourdfpy: {type(err).__name__}: {err}")], "")
    problems: Problems = [] if complete else [(MAIN_URDF, f"yourdfpy: {error}") for error in robot.errors]
    if not robot.validate_filenames():
        problems.append((MAIN_URDF, "yourdfpy: a mesh file does not exist"))
    return count_problems(problems, "yourdfpy finds nothing missing")


def check_paths(subject: Subject, cfg: CheckConfig) -> Finding:
    """V003: every path is relative, inside the folder and exists; every file is referenced."""
    problems: Problems = []
    used = {MAIN_URDF}
    for name, urdf in subject.urdfs.items():
        if isinstance(urdf, PackageError):
            raise urdf
        used |= {name, name.replace(".urdf", ".srdf")}
        files = {s.file for link in urdf.links for s in (*link.visuals, *link.collisions) if s.kind == "mesh"}
        for file in sorted(files):
            used |= _follow(subject, name, file, problems)
    for name in subject.files:
        if name.endswith(".mjcf.xml"):
            used |= {name, *_mjcf_files(subject, name, problems)}
    known = {*SIDECARS, *UNHASHED, *(() if subject.is_package else PARTNET_SIDECARS)}
    if subject.is_package and not isinstance(subject.urdfs.get(MAIN_URDF), PackageError):
        known |= {splats_path(link.name) for link in subject.urdf.links}
    problems += [(n, f"{n}: no file refers to it") for n in subject.files if n not in used | known]
    return count_problems(problems, f"all {len(used)} files that are named exist, and none is left over")


def _follow(subject: Subject, owner: str, reference: str, problems: Problems) -> set[str]:
    """Resolves a reference and, recursively, the references of its file; appends problems."""
    file = _resolve(subject, owner, reference, problems)
    if not file:
        return set()
    found = {file}
    key = _REFERENCES.get(PurePosixPath(file).suffix.lower())
    if key is not None:
        for value in key.findall((subject.folder / file).read_bytes()):
            target = value.decode(errors="replace").strip()
            target = target.split()[-1] if target.startswith("-") else target
            found |= _follow(subject, file, target, problems)
    return found


def _resolve(subject: Subject, owner: str, reference: str, problems: Problems) -> str:
    """Path of the referenced file relative to the folder; "" after reporting a problem."""
    fault = ""
    path = posixpath.normpath(posixpath.join(posixpath.dirname(owner), reference))
    if not reference:
        fault = "an empty file name"
    elif "://" in reference:
        fault = f"{reference!r}, expected a relative path"
    elif reference.startswith(("/", "\\")) or ":" in reference or "\\" in reference:
        fault = f"{reference!r}, an absolute or platform-bound path"
    elif path.startswith(".."):
        fault = f"{reference!r}, which leaves the folder"
    elif path not in subject.files:
        fault = f"{reference!r}, which does not exist"
    if fault and (owner, f"{owner}: refers to {fault}") not in problems:
        problems.append((owner, f"{owner}: refers to {fault}"))
    return "" if fault else path


def _mjcf_files(subject: Subject, name: str, problems: Problems) -> set[str]:
    from xml.etree.ElementTree import ParseError

    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        root = fromstring((subject.folder / name).read_bytes())
    except (ParseError, DefusedXmlException, ValueError) as err:
        problems.append((name, f"{name}: not well-formed XML ({err})"))
        return set()
    compiler = root.find("compiler")
    folders = {} if compiler is None else compiler.attrib
    found: set[str] = set()
    for tag, key in (("mesh", "meshdir"), ("texture", "texturedir")):
        base = folders.get(key, folders.get("assetdir", ""))
        for element in root.iter(tag):
            file = element.get("file")
            if file is not None:
                found |= _follow(subject, name, posixpath.join(base, file), problems)
    return found


def check_joint_types(subject: Subject, cfg: CheckConfig) -> Finding:
    """V004: only joint types that every engine supports."""
    unknown = [joint for joint in subject.urdf.joints if joint.type not in URDF_JOINT_TYPES]
    allowed = ", ".join(URDF_JOINT_TYPES)
    problems = [(j.name, f"joint {j.name!r} has type {j.type!r}, allowed are {allowed}") for j in unknown]
    fine = f"{len(subject.urdf.joints)} joints of known types"
    return count_problems(problems, fine, [joint.child for joint in unknown])


def _moving(subject: Subject) -> list[UrdfJoint]:
    return [joint for joint in subject.urdf.joints if joint.type != "fixed"]


def has_moving_joints(subject: Subject) -> str:
    """Applies if the package has a moving joint."""
    return "" if _moving(subject) else "no joint moves"


def check_limits(subject: Subject, cfg: CheckConfig) -> Finding:
    """V005: finite limits with lower limit 0, unit axes, and ranges that fit the object."""
    problems: Problems = []
    links = []
    for joint in _moving(subject):
        length, faults = float(np.linalg.norm(joint.axis)), []
        if not abs(length - 1.0) <= cfg.axis_tolerance:
            faults.append(f"has an axis of length {length:.9g}, expected 1")
        if joint.type in ("revolute", "prismatic"):
            faults += _range_faults(subject, joint, cfg)
        problems += [(joint.name, f"joint {joint.name!r} {text}") for text in faults]
        links += [joint.child] if faults else []
    return count_problems(problems, f"limits and axes of {len(_moving(subject))} joints are sound", links)


def _range_faults(subject: Subject, joint: UrdfJoint, cfg: CheckConfig) -> list[str]:
    lower, upper = joint.lower, joint.upper
    if lower is None or upper is None:
        return ["has no <limit>"]
    if not np.isfinite([lower, upper]).all():
        return [f"has limits [{lower}, {upper}], expected finite numbers"]
    faults = []
    if lower >= upper:
        faults.append(f"has lower limit {lower:.6g}, not below its upper one {upper:.6g}")
    if joint.mimic is None and abs(lower) > cfg.rest_tolerance:
        faults.append(f"has lower limit {lower:.6g}, expected 0, the closed rest pose")
    turning = joint.type == "revolute"
    allowed = FULL_TURN + cfg.turn_tolerance if turning else subject.diagonal
    if upper - lower > allowed:
        unit, what = ("rad", "a full turn") if turning else ("m", "the object's diagonal")
        faults.append(f"has a range of {upper - lower:.4g} {unit}, more than {what}")
    return faults


def check_counts(subject: Subject, cfg: CheckConfig) -> Finding:
    """V006: the numbers of links and hulls stay within what PhysX handles."""
    links = subject.urdf.links
    if not links:
        return count_problems([(MAIN_URDF, f"{MAIN_URDF}: has no links")], "")
    worst = max(links, key=lambda link: len(link.collisions))
    counts = [
        (len(links), cfg.max_links, "links", MAIN_URDF),
        (len(worst.collisions), cfg.max_hulls_per_link, f"hulls on {worst.name}", worst.name),
        (sum(len(link.collisions) for link in links), cfg.max_hulls, "hulls", MAIN_URDF),
    ]
    count, limit, what, where = max(counts, key=lambda entry: entry[0] / entry[1])
    message = ", ".join(f"{n} of at most {most} {name}" for n, most, name, _ in counts)
    many = [link.name for link in links if len(link.collisions) > cfg.max_hulls_per_link] or [worst.name]
    return at_most(count, limit, what.split()[0], where=where, message=message, links=many)


def is_package(subject: Subject) -> str:
    """Applies to our packages, even if files are missing."""
    return "" if subject.is_package else "the folder is not a package of ours and has no manifest"


def check_manifest(subject: Subject, cfg: CheckConfig) -> Finding:
    """V010: every file has the hash that the manifest states, and the manifest names every file."""
    problems = [(MANIFEST, f"{MANIFEST}: {sentence}") for sentence in manifest_problems(subject.folder)]
    hashed = [name for name in subject.files if name not in UNHASHED]
    return count_problems(problems, f"{len(hashed)} files match their hashes")


def _solid_links(subject: Subject) -> list[UrdfLink]:
    """Links with geometry; an empty root needs no mass."""
    return [link for link in subject.links.values() if link.visuals or link.collisions]


def check_mass(subject: Subject, cfg: CheckConfig) -> Finding:
    """V007: every link with geometry has a plausible mass."""
    masses = {
        link.name: 0.0 if link.inertial is None else link.inertial.mass for link in _solid_links(subject)
    }
    if not masses:
        return count_problems([("", "no link has any geometry")], "")
    small = np.ptp(subject.bounds, axis=0).max() < cfg.small_size
    low, high = cfg.min_small_mass if small else cfg.min_mass, cfg.max_mass
    distance = {
        name: np.inf if not (np.isfinite(mass) and mass > 0) else max(low / mass, mass / high)
        for name, mass in masses.items()
    }
    where = max(distance, key=lambda name: distance[name])
    mass = masses[where]
    message = f"link masses span {min(masses.values()):.4g} to {max(masses.values()):.4g} kg"
    if subject.links[where].inertial is None:
        message = f"link {where!r} states no mass"
    elif distance[where] > 1.0:
        message = f"link {where!r} weighs {mass:.4g} kg, allowed is {low:g} to {high:g} kg"
    return Finding(
        passed=bool(distance[where] <= 1.0),
        value=float(mass) if np.isfinite(mass) else None,
        threshold=high if mass > high else low,
        unit="kg",
        where=where,
        message=message,
        links=tuple(sorted(name for name in masses if not distance[name] <= 1.0)),
    )


def check_inertia(subject: Subject, cfg: CheckConfig) -> Finding:
    """V008: inertia is positive definite, obeys the triangle inequality, and the COM lies in the link."""
    problems = []
    for link in _solid_links(subject):
        if link.inertial is None:
            problems.append((link.name, f"link {link.name!r} states no inertia"))
            continue
        faults = _inertia_faults(link.inertial, cfg)
        T = subject.poses[link.name]
        com = T[:3, :3] @ link.inertial.com + T[:3, 3]
        outside = distance_outside(subject, link.name, com) if np.isfinite(com).all() else 0.0
        if not outside <= cfg.com_tolerance:
            faults.append(f"has its centre of mass {1e3 * outside:.3g} mm outside its convex hull")
        problems += [(link.name, f"link {link.name!r} {fault}") for fault in faults]
    fine = f"inertia of {len(_solid_links(subject))} links is physical"
    return count_problems(problems, fine, [name for name, _ in problems])


def _inertia_faults(inertial: UrdfInertial, cfg: CheckConfig) -> list[str]:
    if not (np.isfinite(inertial.inertia).all() and np.isfinite(inertial.com).all()):
        return ["has an inertia or centre of mass that is not finite"]
    small, middle, large = np.linalg.eigvalsh(inertial.inertia)
    if small <= 0.0:
        return [f"has a principal moment of {small:.3g} kg m2, expected above 0"]
    if large > (small + middle) * (1.0 + cfg.inertia_tolerance):
        return [
            f"has principal moments {small:.4g}, {middle:.4g}, {large:.4g} kg m2, "
            "of which the largest exceeds the sum of the others"
        ]
    return []


def distance_outside(subject: Subject, link: str, point: np.ndarray) -> float:
    """Lower bound on the distance of a point outside the convex hull of a link's vertices (m)."""
    from scipy.spatial import ConvexHull, QhullError

    corners = _extreme(subject, link)
    if len(corners) <= corners.shape[1]:
        return np.inf
    try:
        planes = ConvexHull(corners - point).equations
    except QhullError:
        return np.inf
    return max(0.0, float(planes[:, 3].max()))


def _extreme(subject: Subject, link: str) -> np.ndarray:
    hulls: HullSet = subject.hull_sets[link]
    return hulls.vertices if len(hulls.vertices) else subject.points(link)


def check_size(subject: Subject, cfg: CheckConfig) -> Finding:
    """V009: the object's size is typical of its category, which verifies that lengths are metres."""
    category = str(subject.meta.get("model_cat", ""))
    known = find_category(category)
    low, high = cfg.diagonal_range if known is None else known.diagonal or cfg.diagonal_range
    diagonal = subject.diagonal
    return Finding(
        passed=low <= diagonal <= high,
        value=diagonal,
        threshold=high if diagonal > high else low,
        unit="m",
        where=category,
        message=f"a diagonal of {diagonal:.4g} m, "
        f"expected {low:g} to {high:g} m for {category or 'any object'}",
    )


FILE_CHECKS = (
    CheckSpec(id="V001", level="L0", title="one tree", applies=always, function=check_tree),
    CheckSpec(id="V002", level="L0", title="yourdfpy validates", applies=always, function=check_schema),
    CheckSpec(id="V003", level="L0", title="paths", applies=always, function=check_paths),
    CheckSpec(id="V004", level="L0", title="joint types", applies=always, function=check_joint_types),
    CheckSpec(
        id="V005", level="L0", title="axes and limits", applies=has_moving_joints, function=check_limits
    ),
    CheckSpec(id="V006", level="L0", title="counts", applies=always, function=check_counts),
    CheckSpec(id="V007", level="L0", title="mass", applies=always, function=check_mass),
    CheckSpec(id="V008", level="L0", title="inertia", applies=always, function=check_inertia),
    CheckSpec(id="V009", level="L0", title="size in metres", applies=always, function=check_size),
    CheckSpec(id="V010", level="L0", title="manifest", applies=is_package, function=check_manifest),
)
