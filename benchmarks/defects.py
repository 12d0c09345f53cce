"""Named defects of a sound package, each with the check that must catch it.

Every mutation edits files as a careless tool or person would. The manifest is sealed again after it
(unless the defect is the broken seal itself), so that the hash does not do the other checks' work.
"""

import re
import shutil
import xml.etree.ElementTree as ET  # edits files written by ourselves
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from sim_export.files.obj import hull_obj_text, parse_obj, png_bytes
from sim_export.files.read import read_package
from sim_export.files.urdf import format_vector, link_origins
from sim_export.files.write import UNHASHED, manifest_text
from sim_export.geometry.hulls import convex_hull
from sim_export.package import Hull

URDF = "mobility.urdf"
Mutation = Callable[[Path], None]


@dataclass(frozen=True, kw_only=True)
class Defect:
    """A way to break a package, and the check meant to catch it."""

    name: str
    check: str
    mutate: Mutation
    base: Literal["cabinet", "double"] = "cabinet"
    reseal: bool = True


def seed_defect(defect: Defect, good: Path, folder: Path) -> Path:
    """Copies a good package to ``folder``, all its collision shapes as mesh files, and breaks the copy."""
    shutil.copytree(good, folder)
    mesh_collisions(folder)
    defect.mutate(folder)
    if defect.reseal:
        files = {p.relative_to(folder).as_posix(): p for p in sorted(folder.rglob("*")) if p.is_file()}
        content = {name: path.read_bytes() for name, path in files.items() if name not in UNHASHED}
        (folder / "manifest.json").write_text(manifest_text(content))
    return folder


def mesh_collisions(folder: Path) -> None:
    """Writes boxes and cylinders as the mesh files that mutations edit; the geometry stays the same."""
    package = read_package(folder, appearance=False)
    origins, hulls = link_origins(package), {link.name: link.hulls for link in package.links}

    def change(robot: ET.Element) -> None:
        for link in robot.findall("link"):
            name = link.get("name", "")
            for index, collision in enumerate(link.findall("collision")):
                geometry = find(collision, "geometry")
                if geometry.find("mesh") is not None:
                    continue
                file = f"collision/{name}_{index}.obj"
                (folder / file).parent.mkdir(exist_ok=True)
                _write(folder / file, hulls[name][index])
                find(collision, "origin").attrib.update(xyz=format_vector(-origins[name]), rpy="0 0 0")
                geometry.clear()
                ET.SubElement(geometry, "mesh", filename=file)

    edit_urdf(change)(folder)


def edit_urdf(change: Callable[[ET.Element], object]) -> Mutation:
    """Changes the URDF's element tree."""

    def mutate(folder: Path) -> None:
        tree = ET.parse(folder / URDF)
        root = tree.getroot()
        assert root is not None
        change(root)
        tree.write(folder / URDF)

    return mutate


def set_attribute(path: str, **values: str) -> Mutation:
    """Sets attributes of the element at an XPath."""

    def change(robot: ET.Element) -> None:
        find(robot, path).attrib.update(values)

    return edit_urdf(change)


def find(robot: ET.Element, path: str) -> ET.Element:
    """The element at an XPath."""
    element = robot.find(path)
    assert element is not None, path
    return element


def drop(parent: str, child: str) -> Mutation:
    """Removes the first ``child`` of the element at ``parent``."""

    def change(robot: ET.Element) -> None:
        owner = find(robot, parent)
        owner.remove(find(owner, child))

    return edit_urdf(change)


def replace_text(file: str, old: str, new: str) -> Mutation:
    """Replaces the first occurrence of some text."""

    def mutate(folder: Path) -> None:
        text = (folder / file).read_text()
        assert old in text, f"{file}: no {old!r}"
        (folder / file).write_text(text.replace(old, new, 1))

    return mutate


def edit_vertices(pattern: str, change: Callable[[np.ndarray], np.ndarray]) -> Mutation:
    """Moves the vertices of every OBJ that matches."""

    def mutate(folder: Path) -> None:
        paths = sorted(folder.glob(pattern))
        assert paths, pattern
        for path in paths:
            lines = path.read_text().splitlines()
            rows = [index for index, line in enumerate(lines) if line.startswith("v ")]
            moved = change(np.array([[float(word) for word in lines[row].split()[1:4]] for row in rows]))
            for row, (x, y, z) in zip(rows, moved, strict=True):
                lines[row] = f"v {x:.6f} {y:.6f} {z:.6f}"
            path.write_text("\n".join(lines) + "\n")

    return mutate


def shift(pattern: str, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Mutation:
    """Shifts every OBJ that matches (m)."""
    return edit_vertices(pattern, lambda vertices: vertices + np.array([x, y, z]))


def chain(*mutations: Mutation) -> Mutation:
    """One mutation after the other."""

    def mutate(folder: Path) -> None:
        for mutation in mutations:
            mutation(folder)

    return mutate


def write_hull(file: str, vertices: np.ndarray) -> Mutation:
    """Puts the convex hull of some points in the place of a collision file."""
    return lambda folder: _write(folder / file, convex_hull(vertices))


def _write(path: Path, hull: Hull) -> None:
    path.write_text(hull_obj_text(hull, path.stem))


def fill_link(link: str) -> Mutation:
    """One hull around a link in the place of all its hulls."""

    def mutate(folder: Path) -> None:
        paths = sorted(folder.glob(f"collision/{link}_*.obj"))
        _write(paths[0], convex_hull(np.concatenate([parse_obj(path).vertices for path in paths])))

        def change(robot: ET.Element) -> None:
            owner = find(robot, f"link[@name='{link}']")
            for collision in owner.findall("collision")[1:]:
                owner.remove(collision)

        edit_urdf(change)(folder)
        for path in paths[1:]:
            path.unlink()

    return mutate


def scale_all(factor: float) -> Mutation:
    """Writes all lengths in another unit."""

    def mutate(folder: Path) -> None:
        edit_vertices("*/*.obj", lambda vertices: vertices * factor)(folder)

        def change(robot: ET.Element) -> None:
            for origin in robot.iter("origin"):
                words = [float(word) * factor for word in origin.get("xyz", "0 0 0").split()]
                origin.set("xyz", " ".join(f"{word:.9g}" for word in words))
            for joint in robot.findall("joint[@type='prismatic']"):
                limit = find(joint, "limit")
                limit.set("upper", f"{float(limit.get('upper', '0')) * factor:.9g}")

        edit_urdf(change)(folder)

    return mutate


def turn_axis(joint: str) -> Mutation:
    """Reverses a joint's axis."""

    def change(robot: ET.Element) -> None:
        axis = find(robot, f"joint[@name='{joint}']/axis")
        axis.set("xyz", " ".join(f"{-float(word):g}" for word in axis.get("xyz", "").split()))

    return edit_urdf(change)


def move_joint(joint: str, y: float) -> Mutation:
    """Moves a joint's line sideways (m) and leaves all geometry where it is."""

    def change(robot: ET.Element) -> None:
        element = find(robot, f"joint[@name='{joint}']")
        child = find(element, "child").get("link")
        _shift_origin(find(element, "origin"), y)
        origins = [find(robot, f"link[@name='{child}']")]
        origins += [j for j in robot.findall("joint") if find(j, "parent").get("link") == child]
        for owner in origins:
            for origin in owner.iter("origin"):
                _shift_origin(origin, -y)

    return edit_urdf(change)


def _shift_origin(origin: ET.Element, y: float) -> None:
    words = [float(word) for word in origin.get("xyz", "0 0 0").split()]
    origin.set("xyz", f"{words[0]:.9g} {words[1] + y:.9g} {words[2]:.9g}")


def edit_faces(file: str, change: Callable[[list[str]], list[str]]) -> Mutation:
    """Changes the face lines of an OBJ."""

    def mutate(folder: Path) -> None:
        lines = (folder / file).read_text().splitlines()
        faces = [line for line in lines if line.startswith("f ")]
        rest = [line for line in lines if not line.startswith("f ")]
        (folder / file).write_text("\n".join([*rest, *change(faces)]) + "\n")

    return mutate


def reverse_face(line: str) -> str:
    """A face wound the other way round."""
    return " ".join(["f", *reversed(line.split()[1:])])


def paint(pattern: str, color: tuple[int, int, int]) -> Mutation:
    """Fills textures with one color."""

    def mutate(folder: Path) -> None:
        paths = sorted(folder.glob(pattern))
        assert paths, pattern
        for path in paths:
            path.write_bytes(png_bytes(np.tile(np.array(color, dtype=np.uint8), (16, 16, 1))))

    return mutate


def set_uv(file: str, u: float, v: float) -> Mutation:
    """Puts all texture coordinates into one point."""

    def mutate(folder: Path) -> None:
        text = (folder / file).read_text()
        (folder / file).write_text(re.sub(r"(?m)^vt .*$", f"vt {u:.6f} {v:.6f}", text))

    return mutate


def join_files(file: str, other: str) -> Mutation:
    """Writes the solids of two OBJs of one link into the first."""

    def mutate(folder: Path) -> None:
        one, two = parse_obj(folder / file), parse_obj(folder / other)
        faces = np.concatenate([one.faces, two.faces + len(one.vertices)]) + 1
        rows = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in [*one.vertices, *two.vertices]]
        rows += [f"f {a} {b} {c}" for a, b, c in faces]
        (folder / file).write_text("\n".join(rows) + "\n")

    return mutate


def delete(file: str) -> Mutation:
    """Removes a file."""
    return lambda folder: (folder / file).unlink()


def append(file: str, text: str) -> Mutation:
    """Adds text to a file, which may be new."""

    def mutate(folder: Path) -> None:
        path = folder / file
        path.write_text((path.read_text() if path.exists() else "") + text)

    return mutate
