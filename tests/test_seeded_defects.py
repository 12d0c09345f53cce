"""Every seeded defect is caught by the check meant for it; the good packages pass every check."""

from dataclasses import replace
from pathlib import Path

import pytest
from defects import Defect, seed_defect
from sample_packages import write_samples
from static_defects import STATIC_DEFECTS

from sim_export.checks.config import CheckConfig
from sim_export.checks.draft import read_draft
from sim_export.checks.registry import run_check
from sim_export.checks.subject import Subject
from sim_export.checks.suite import CHECKS, run_checks
from sim_export.files.read import read_package

SPECS = {spec.id: spec for spec in CHECKS}


@pytest.fixture(scope="session")
def good_packages(tmp_path_factory) -> dict[str, Path]:
    return write_samples(tmp_path_factory.mktemp("good"))


@pytest.mark.parametrize("base", ["cabinet", "double"])
def test_good_package_passes_everything(good_packages, base):
    results = run_checks(good_packages[base])
    assert [result.id for result in results] == sorted(SPECS)
    assert {result.id: result.message for result in results if result.verdict == "fail"} == {}
    skipped = {result.id for result in results if result.verdict == "not_applicable"}
    assert skipped == ({"V205"} if base == "cabinet" else set())


@pytest.mark.parametrize("defect", STATIC_DEFECTS, ids=lambda defect: defect.name.replace(" ", "-"))
def test_defect_is_caught_by_its_check(good_packages, tmp_path, defect: Defect):
    folder = seed_defect(defect, good_packages[defect.base], tmp_path / "package")
    result = run_check(SPECS[defect.check], Subject(folder), CheckConfig())
    assert result.verdict == "fail", result.message
    # Caught by what it measured, not by falling over what it could not read.
    assert result.value is not None or defect.check == "V007", result.message
    assert "crashed" not in result.message
    # Checks of whole files and of the whole object's size name no link.
    named = defect.check not in {"V001", "V002", "V003", "V009", "V010"} and result.value is not None
    links = {link.name for link in Subject(folder).urdf.links} if named else set()
    assert set(result.links) <= links
    assert result.links or not named


@pytest.mark.parametrize("base", ["cabinet", "double"])
def test_a_draft_is_judged_like_its_folder(good_packages, base):
    """Checks of geometry and motion find the same in memory as in the files."""
    folder = good_packages[base]
    drafted = run_checks(read_draft(read_package(folder)), ("L1", "L2"))
    written = run_checks(folder, ("L1", "L2"))
    of_files = {"V106"}  # images
    assert [replace(check, seconds=0.0) for check in drafted if check.id not in of_files] == [
        replace(check, seconds=0.0) for check in written if check.id not in of_files
    ]


def test_every_check_has_a_defect():
    assert {defect.check for defect in STATIC_DEFECTS} == set(SPECS)


def test_unbroken_copy_is_still_good(good_packages, tmp_path):
    """Sealing again and copying is not what the checks notice."""
    idle = Defect(name="nothing", check="V001", mutate=lambda folder: None)
    folder = seed_defect(idle, good_packages["cabinet"], tmp_path / "elsewhere")
    before, after = run_checks(good_packages["cabinet"]), run_checks(folder)
    assert [(r.id, r.verdict) for r in after] == [(r.id, r.verdict) for r in before]
    for now, then in zip(after, before, strict=True):  # mesh files hold micrometres
        assert now.value == pytest.approx(then.value, abs=2e-5), now.id
