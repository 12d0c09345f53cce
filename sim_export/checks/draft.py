"""Packages as checks of geometry and motion read them, without a folder."""

from collections.abc import MutableMapping
from pathlib import Path

from artigen.files.wavefront import ObjText
from sim_export.checks.subject import Subject, as_text
from sim_export.files.obj import parse_obj, round_hull
from sim_export.files.urdf import hull_path, visual_path
from sim_export.files.write import package_texts
from sim_export.geometry.primitives import find_primitive
from sim_export.package import Mesh, SimPackage


def read_draft(package: SimPackage, known: MutableMapping[Path, ObjText] | None = None) -> Subject:
    """A package that is not on disk; only checks of files need its folder.

    Args:
        known: Meshes of the source that were read before; it gets those that are read now.

    Raises:
        InvalidKinematics: If links and joints are not a tree that URDF can express.
        PackageError: If a source mesh cannot be read.
    """
    folder, read = Path(package.name), {} if known is None else known
    meshes: dict[Path, ObjText] = {}
    for link in package.links:
        for visual in link.visuals:
            mesh = visual.mesh
            if not isinstance(mesh, Mesh) and mesh.path not in read:
                read[mesh.path] = parse_obj(mesh.path)
            meshes[folder / visual_path(visual)] = (
                as_text(mesh) if isinstance(mesh, Mesh) else read[mesh.path]
            )
        for index, hull in enumerate(link.hulls):
            if find_primitive(hull) is None:
                rounded = round_hull(hull)
                mesh = Mesh(vertices=rounded.vertices, faces=rounded.faces)
                meshes[folder / hull_path(link, index)] = as_text(mesh)
    return Subject(folder, meshes, package_texts(package, engines=False))
