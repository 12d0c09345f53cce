"""Packages as checks read them, without writing and parsing the meshes of visuals."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from sim_export.checks.subject import Subject, as_text
from sim_export.files.obj import parse_obj
from sim_export.files.urdf import visual_path
from sim_export.files.write import write_draft
from sim_export.package import Mesh, SimPackage


@contextmanager
def open_draft(package: SimPackage) -> Iterator[Subject]:
    """A package for checks of geometry and motion; its folder is gone afterwards."""
    with TemporaryDirectory() as scratch:
        folder = write_draft(package, Path(scratch) / package.name, visuals=False)
        meshes = {
            folder / visual_path(visual): as_text(visual.mesh)
            if isinstance(visual.mesh, Mesh)
            else parse_obj(visual.mesh.path)
            for link in package.links
            for visual in link.visuals
        }
        yield Subject(folder, meshes)


def read_draft(package: SimPackage) -> Subject:
    """A package whose openings and handles can be judged without its folder."""
    with open_draft(package) as subject:
        read = (subject.visuals, subject.hull_sets, subject.labels, subject.driven, subject.annotations)
        assert all(part is not None for part in read)
    return subject
