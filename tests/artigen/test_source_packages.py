"""What libraries load from a source is what they load from its package."""

from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from project import ROOT
from source_oracles import compare_package, load_source

from artigen.api.convert import ConvertJob, convert_object

FILES = ("cabinet_urdf.urdf", "cabinet_mjcf.xml", "cabinet_usd.usda")


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_a_package_is_loaded_as_its_source(tmp_path: Path, name: str):
    pytest.importorskip("pxr")
    job = ConvertJob(source=ROOT / "examples" / "sources" / name, out=tmp_path)
    convert_object(job)
    with TemporaryDirectory() as scratch:
        found = job.read(Path(scratch))
    assert compare_package(found, load_source(job.source, None), tmp_path / job.key) == []
