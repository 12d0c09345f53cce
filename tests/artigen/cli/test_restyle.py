"""`artigen restyle`: packages that differ in their looks alone."""

import json
from pathlib import Path

import numpy as np
import pytest

import artigen
from artigen.cli.restyle import restyle
from artigen.errors import ArtigenError


@pytest.mark.slow
def test_the_command_writes_packages_that_differ_in_their_looks(tmp_path: Path, capsys):
    cabinet = artigen.sample("StorageFurniture", 3)
    cabinet.export(tmp_path / "cabinet")
    assert restyle((tmp_path / "cabinet",), tmp_path / "out", seed=4, count=2) == 0
    folders = [Path(line) for line in capsys.readouterr().out.splitlines()]
    assert [folder.name for folder in folders] == [f"{cabinet.name}-l4", f"{cabinet.name}-l5"]
    said = [json.loads((folder / "materials.json").read_text()) for folder in folders]
    assert said[0]["materials"] != said[1]["materials"]
    assert [v["finish"] for v in said[0]["visuals"]] == [v["finish"] for v in said[1]["visuals"]]
    first, other = (artigen.load(folder).package for folder in folders)
    for one, two in zip(first.links, other.links, strict=True):
        for a, b in zip(one.visuals, two.visuals, strict=True):
            np.testing.assert_array_equal(a.mesh.vertices, b.mesh.vertices)
            np.testing.assert_array_equal(a.mesh.uv, b.mesh.uv)


@pytest.mark.parametrize(("seed", "count"), [(-1, 1), (0, 0)])
def test_numbers_out_of_range_are_refused(tmp_path: Path, seed: int, count: int):
    with pytest.raises(ArtigenError, match=f"{count} looks from seed {seed}: expected at least one"):
        restyle((tmp_path,), tmp_path, seed=seed, count=count)
