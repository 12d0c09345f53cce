"""Runs over many objects: one bad source harms no other, and a rerun does only what is missing."""

import json
import shutil
from pathlib import Path

import pytest
from sample_partnet import write_sample

from artigen.api.batch import Finished, read_journal
from artigen.api.convert import ConvertSettings
from artigen.cli.convert import convert
from artigen.cli.export import export
from artigen.cli.summary import print_summary
from artigen.cli.validate import validate
from artigen.datasets.sources import find_sources
from artigen.errors import ArtigenError
from artigen.io import write_asset

SETTINGS = ConvertSettings(visual="voxels", validation="none")


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> tuple[Path, Path, int]:
    """Sources (one good, one broken) and the output of a run over both."""
    base = tmp_path_factory.mktemp("run")
    write_sample(base / "sources" / "good")
    shutil.copytree(base / "sources" / "good", base / "sources" / "broken")
    (base / "sources" / "broken" / "mobility_v2.json").write_text("[{]")
    code = convert((base / "sources",), base / "out", SETTINGS, workers=1)
    return base / "sources", base / "out", code


@pytest.mark.slow
def test_a_broken_source_is_one_sentence_and_the_others_are_done(run):
    _, out, code = run
    journal = read_journal(out)
    assert code == 1
    assert journal["good"].good
    assert (out / "good" / "mobility.urdf").is_file()
    assert not (out / "broken").exists()
    error = journal["broken"].error
    assert error is not None
    assert "mobility_v2.json" in error
    assert "\n" not in error


@pytest.mark.slow
def test_a_rerun_does_only_what_is_missing(run, tmp_path):
    sources, out, _ = run
    before = (out / "good" / "mobility.urdf").stat().st_mtime_ns
    shutil.copytree(sources, tmp_path / "sources")
    write_sample(tmp_path / "fixed")
    shutil.copy(tmp_path / "fixed" / "mobility_v2.json", sources / "broken" / "mobility_v2.json")
    with (out / "run.jsonl").open("a") as journal:
        journal.write('{"key": "broken", "settings": "cut short by a kil')
        journal.write("\n")
    assert convert((sources,), out, SETTINGS, workers=1) == 0
    assert (out / "good" / "mobility.urdf").stat().st_mtime_ns == before
    assert (out / "broken" / "mobility.urdf").is_file()


def test_two_sources_of_one_name_are_refused(run, tmp_path):
    sources, _, _ = run
    shutil.copytree(sources / "good", tmp_path / "elsewhere" / "good")
    with pytest.raises(ArtigenError, match="several sources are called good"):
        convert((sources / "good", tmp_path / "elsewhere" / "good"), tmp_path / "out", SETTINGS)


def test_a_folder_that_is_no_object_is_a_source_by_itself(tmp_path):
    """It then fails with the reader's sentence, instead of being passed over in silence."""
    assert find_sources((tmp_path,)) == [tmp_path]


@pytest.mark.parametrize(
    ("sources", "cfg", "said"),
    [
        ((), {}, "no sources"),
        (("gone.urdf",), {}, "gone.urdf: no such file or folder"),
        ((".",), {"size": 0.0}, "size 0.0 m"),
        ((".",), {"size": float("nan")}, "size nan m"),
        ((".",), {"budget": -1.0}, "no budget below 0"),
    ],
)
def test_what_cannot_be_converted_is_refused_before_any_work(tmp_path, sources, cfg, said):
    with pytest.raises(ArtigenError, match=said):
        convert(tuple(map(Path, sources)), tmp_path / "out", ConvertSettings(**cfg))
    assert not (tmp_path / "out").exists()


def test_journal_lines_survive_a_round_trip(tmp_path):
    line = Finished(key="a", settings="s", passed=False, failures=("V101 x",), seconds=(("read", 0.5),))
    (tmp_path / "run.jsonl").write_text(json.dumps(line.__dict__) + "\n")
    assert read_journal(tmp_path)["a"] == line


@pytest.mark.slow
def test_validate_says_what_failed_and_exits_with_it(run, tmp_path, capsys):
    _, out, _ = run
    assert validate((out / "good",), tmp_path / "all.json") == 0
    (report,) = json.loads((tmp_path / "all.json").read_text())
    assert report["passed"]
    worse = tmp_path / "worse"
    shutil.copytree(out / "good", worse)
    next(iter(sorted((worse / "collision").glob("*.obj")))).unlink()
    assert validate((worse,)) == 1
    assert "FAIL worse" in capsys.readouterr().out


@pytest.mark.slow
def test_an_asset_folder_becomes_a_package(cabinet, tmp_path):
    write_asset(cabinet, tmp_path / "asset")
    assert export(tmp_path / "asset", tmp_path / "package") == 0
    assert (tmp_path / "package" / "mobility.urdf").is_file()
    with pytest.raises(ArtigenError, match="package"):
        export(tmp_path / "asset", tmp_path / "package")


OUTCOMES = {
    "passed": Finished(key="a", settings="", passed=True),
    "failed": Finished(key="b", settings="", passed=False),
    "unchecked": Finished(key="c", settings=""),
    "lost": Finished(key="d", settings="", error="no"),
}


@pytest.mark.parametrize("numbers", [(2, 0, 0, 0), (1, 1, 0, 0), (0, 0, 3, 0), (0, 0, 0, 1), (1, 2, 3, 4)])
def test_the_summary_counts_every_object_once_and_checks_only_where_there_were_some(capsys, numbers):
    def name(count, noun):
        return f"{count} {noun}" if count == 1 else f"{count} {noun}s"

    results = [one for one, count in zip(OUTCOMES.values(), numbers, strict=True) for _ in range(count)]
    passed, failed, unchecked, lost = numbers
    assert print_summary(results, Path("out")) == (1 if failed or lost else 0)
    said = capsys.readouterr().out.strip().split(", ")
    expected = [f"{name(sum(numbers), 'object')}: {name(sum(numbers) - lost, 'package')} in out"]
    expected += [f"{passed} of them passed every check"] if passed + failed else []
    expected += [f"{unchecked} of them not checked"] if unchecked else []
    expected += [f"{lost} not made"] if lost else []
    assert said == expected
