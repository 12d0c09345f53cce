"""The exact sample cabinet as a package, and in a folder of its own for each file of tests."""

from pathlib import Path

import pytest
from sample_packages import SAMPLE_PARTS, build_package

from sim_export.files.write import write_package
from sim_export.package import SimPackage


@pytest.fixture(scope="module")
def package() -> SimPackage:
    """The sample cabinet; files of tests that need another one replace it."""
    return build_package(SAMPLE_PARTS)


@pytest.fixture(scope="module")
def folder(package: SimPackage, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the package."""
    return write_package(package, tmp_path_factory.mktemp("packages") / "cabinet")
