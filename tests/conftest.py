"""Shared fixtures: the embedded sample cabinet, and real objects where they are at hand."""

import gc
from dataclasses import replace
from pathlib import Path

import hypothesis
import numpy as np
import pytest
from jaxtyping import install_import_hook

with install_import_hook(["artigen", "sim_export", "envs"], "beartype.beartype"):
    from sample_cabinet import sample_asset

    from artigen.types import Asset
    from artigen.voxels.cleanup.rows import Owners, read_owners
    from artigen.voxels.fields import VoxelFields, decode, encode, tabulate_parts
    from artigen.voxels.voxelize import voxelize

hypothesis.settings.register_profile(
    "busy machine", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.load_profile("busy machine")

REAL_OBJECTS = Path(__file__).resolve().parents[2] / "shared" / "data"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--require-real", action="store_true", help="missing real objects fail the tests")


def pytest_collection_finish() -> None:
    """Exempts modules and tests from garbage collection, which ManiSkill runs at every reset."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session")
def cabinet() -> Asset:
    """The sample cabinet with surface samples and voxels."""
    asset = sample_asset()
    assert asset.surface is not None
    return replace(asset, voxels=voxelize(asset.surface))


@pytest.fixture(scope="session")
def cabinet_fields(cabinet: Asset) -> VoxelFields:
    """The fields of the sample cabinet."""
    return decode(encode(cabinet))


@pytest.fixture(scope="session")
def cabinet_rows(cabinet: Asset) -> np.ndarray:
    """Its outline, one row per part."""
    return tabulate_parts(cabinet)


@pytest.fixture(scope="session")
def cabinet_owners(cabinet_fields: VoxelFields, cabinet_rows: np.ndarray) -> Owners:
    """The row of that outline that each of its cells belongs to."""
    return read_owners(cabinet_fields, cabinet_rows)


@pytest.fixture(scope="session")
def trellis_reference(real_objects: Path) -> Path:
    """Folder with tiny random TRELLIS networks and what TRELLIS' own classes gave for them."""
    return real_objects / "trellis_reference"


@pytest.fixture(scope="session")
def real_objects(pytestconfig: pytest.Config) -> Path:
    """Folder with ``partnet_mobility/`` and ``splits.json``; skips where there is none."""
    if not REAL_OBJECTS.is_dir():
        message = f"no PartNet-Mobility objects under {REAL_OBJECTS}"
        if pytestconfig.getoption("--require-real"):
            pytest.fail(message)
        pytest.skip(message)
    return REAL_OBJECTS
