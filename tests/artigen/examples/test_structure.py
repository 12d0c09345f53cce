"""Examples of the structure models: drawn from seeds, kept in shards, dealt in batches."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from artigen.errors import SourceError
from artigen.examples.batches import draw_batches, prefetch
from artigen.examples.structure import StructureExample, draw_example, read_shard, write_shard


@pytest.fixture(scope="module")
def examples() -> list[StructureExample]:
    return [draw_example("Microwave", seed, resolution=32, image_size=32)[1] for seed in (0, 1)]


def test_examples_follow_from_their_seed(examples: list[StructureExample]):
    _, again = draw_example("Microwave", 1, resolution=32, image_size=32)
    assert np.array_equal(again.field.rows, examples[1].field.rows)
    assert np.array_equal(again.image, examples[1].image)
    assert not np.array_equal(examples[0].image, examples[1].image)


def test_a_picture_shows_the_object_in_full(examples: list[StructureExample]):
    for example in examples:
        assert example.image is not None
        alpha = example.image[..., 3] > 0
        border = np.concatenate([alpha[0], alpha[-1], alpha[:, 0], alpha[:, -1]])
        assert alpha.mean() > 0.2
        assert not border.any()
        assert not example.image[~alpha].any()


def test_shards_give_back_what_was_written(tmp_path: Path, examples: list[StructureExample]):
    path = tmp_path / "shard.npz"
    write_shard(path, examples)
    for one, two in zip(read_shard(path), examples, strict=True):
        assert (one.name, one.category) == (two.name, two.category)
        for name in ("counts", "size", "image"):
            assert np.array_equal(getattr(one, name), getattr(two, name))
        for name in ("resolution", "index", "rows", "table"):
            assert np.array_equal(getattr(one.field, name), getattr(two.field, name))
    write_shard(path, [replace(example, image=None) for example in examples])
    assert all(example.image is None for example in read_shard(path))
    assert [file.name for file in tmp_path.iterdir()] == ["shard.npz"]


def test_what_is_no_whole_shard_is_named(tmp_path: Path, examples: list[StructureExample]):
    path = tmp_path / "shard.npz"
    write_shard(path, examples)
    whole = path.read_bytes()
    for content in (whole[: len(whole) // 2], b"", b"hello"):
        path.write_bytes(content)
        with pytest.raises(SourceError, match=r"shard.npz: is no complete shard .* delete it"):
            list(read_shard(path))
    np.savez(path, names=np.array(["one"]))
    with pytest.raises(SourceError, match="it lacks categories, counts"):
        list(read_shard(path))


def test_every_epoch_holds_every_example_once():
    batches = draw_batches(range(7), tuple, 3, seed=0)
    drawn = list(itertools.chain.from_iterable(itertools.islice(batches, 7)))
    assert [sorted(drawn[start : start + 7]) for start in (0, 7, 14)] == [list(range(7))] * 3
    assert drawn[:7] != drawn[7:14]


def test_prefetching_keeps_order_and_errors():
    def batches():
        yield from range(5)
        raise KeyError("sixth")

    ahead = prefetch(batches(), depth=2)
    assert list(itertools.islice(ahead, 5)) == list(range(5))
    with pytest.raises(KeyError, match="sixth"):
        next(ahead)
