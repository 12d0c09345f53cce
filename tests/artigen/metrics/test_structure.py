"""Reconstruction rows of a network that is exact and of one that is not; retrieval; subjects by seed."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from grammar_source import grammar_source

from artigen.examples.shards import ShardConfig, ShardJob
from artigen.examples.structure import make_shard, read_shard
from artigen.latent.presets import PRESETS
from artigen.latent.structure_vae import StructureVae
from artigen.metrics import structure
from artigen.metrics.asks import condition_distance, retrieve
from artigen.metrics.instantiation import pose_set
from artigen.metrics.score import ScoreConfig, score_novelty, score_objects, score_set
from artigen.metrics.strict import PENALTY
from artigen.metrics.structure import score_reconstruction, score_spread
from artigen.metrics.subjects import Field, Subject, describe_subject, draw_subjects
from artigen.models.conditions import StructureCondition
from artigen.shapes.draw import ShapeError
from artigen.voxels.fields import ROW

COARSE = ScoreConfig(per_part=100, points=1000)
SHARES = (
    "occupancy_recall",
    "occupancy_precision",
    "occupancy_iou",
    "label",
    "joint_type",
    "moving_joint_type",
)
EVERYTHING: tuple[Field, ...] = ("category", "counts", "size", "image")
FIELDS: tuple[tuple[Field, ...], ...] = (EVERYTHING, ("image",), ("category", "size"))


@pytest.fixture(scope="module")
def subjects() -> list[Subject]:
    return draw_subjects(("Oven", "Microwave"), 0, 6, resolution=32, image_size=32)


class Oracle(StructureVae):
    """Says what it was shown, with a fixed error on the cells of one half of space."""

    def __init__(self, error: float) -> None:
        super().__init__(PRESETS["tiny"].vae)
        self.error = error

    def encode(self, patches):
        self.shown = patches
        empty = torch.zeros(patches.samples, self.latent_channels, 1, 1, 1)
        return empty, empty

    def decode(self, z, index=None, outlines=None, steady=None):
        assert index is not None
        values = self.shown.attributes().clone()
        values[:, ::2, ROW.axis.stop :][..., :3] += self.error  # origins of every second cell
        return 2.0 * self.shown.occupancy().flatten(0, 1) - 1.0, values, index


def test_what_is_said_exactly_scores_perfectly(subjects: list[Subject], monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(structure, "BATCH", 4)
    examples = [subject.example for subject in subjects]
    scores = score_reconstruction(Oracle(0.0), examples)
    assert [scores[name] for name in SHARES] == [1.0] * len(SHARES)
    rest = {name: value for name, value in scores.items() if name not in (*SHARES, "small_label")}
    assert max(rest.values()) == pytest.approx(0.0, abs=0.05)  # the axis comes from an arc cosine
    spread = score_spread(Oracle(0.0), examples)
    assert {name: len(values) for name, values in spread.items()}["origin"] == 3
    assert max(value for values in spread.values() for value in values) == pytest.approx(0.0, abs=1e-6)


def test_errors_are_told_with_their_size(subjects: list[Subject]):
    examples = [subject.example for subject in subjects]
    scores = score_reconstruction(Oracle(0.1), examples)
    # About half of the cells are off by 0.1 along x, y and z each.
    assert scores["origin"] == pytest.approx(0.5 * 0.1 * 3**0.5, rel=0.2)
    assert 0 < scores["line"] < scores["origin"]
    spread = score_spread(Oracle(0.1), examples)
    assert spread["origin"] == pytest.approx([0.05] * 3, rel=0.3)
    assert max(spread["box_size"]) == pytest.approx(0.0, abs=1e-6)


def test_subjects_are_the_objects_of_the_shards(subjects: list[Subject], tmp_path):
    cfg = ShardConfig(categories=("Oven", "Microwave"), first_seed=0, objects=6, resolution=32, image_size=32)
    threads = torch.get_num_threads()
    path = make_shard(ShardJob(path=tmp_path / "shard.npz", number=0, cfg=cfg))
    torch.set_num_threads(threads)
    for subject, example in zip(subjects, read_shard(path), strict=True):
        assert subject.example.name == example.name
        assert np.array_equal(subject.example.field.rows, example.field.rows)
        assert subject.example.image is not None
        assert example.image is not None
        assert np.array_equal(subject.example.image, example.image)


def test_retrieval_finds_the_object_itself(subjects: list[Subject]):
    for subject in subjects:
        for fields in FIELDS:
            asked = describe_subject(subject, fields)
            assert condition_distance(asked, subject) == pytest.approx(0.0, abs=1e-5)
            assert retrieve(asked, subjects) is subject


def test_retrieval_keeps_to_the_category_and_prefers_counts(subjects: list[Subject]):
    asked = describe_subject(subjects[0], ("category", "counts"))
    assert retrieve(asked, subjects[1:]).example.category == "Oven"
    other = retrieve(asked, [one for one in subjects[1:] if one.example.category == "Oven"])
    wrong = np.abs(other.example.counts.astype(int) - subjects[0].example.counts.astype(int)).sum()
    assert condition_distance(asked, other) == wrong
    with pytest.raises(ValueError, match="none of 3 objects"):
        retrieve(asked, subjects[1::2])


def test_scores_count_what_failed(subjects: list[Subject]):
    truths = [subject.asset for subject in subjects]
    wanted = [describe_subject(subject, EVERYTHING) for subject in subjects]
    perfect = score_objects(wanted, truths, truths, COARSE)
    assert [perfect[name] for name in ("valid", "category", "counts", "size")] == [1.0] * 4
    assert perfect["strict_articulated"] == 0.0
    half = [asset if number % 2 else None for number, asset in enumerate(truths)]
    scores = score_objects(wanted, half, truths, COARSE)
    assert [scores[name] for name in ("valid", "category", "counts", "size")] == [0.5] * 4
    assert scores["strict_rest"] == pytest.approx(PENALTY / 2)
    assert scores["strict_rest_matched"] == 0.0
    nothing = score_objects(wanted, [None] * len(truths), truths, COARSE)
    assert nothing["strict_rest"] == pytest.approx(PENALTY)
    assert "compat_rest" not in nothing


def test_sets_are_compared_place_by_place(subjects: list[Subject]):
    truths = [subject.asset for subject in subjects]
    cfg = replace(COARSE.poses, points=64, poses=2)
    held = pose_set(truths, cfg)
    scores = score_set([None, *truths[1:5], None], held, cfg)
    assert (scores["compared"], scores["coverage"], scores["mmd"], scores["one_nna"]) == (4, 1, 0, 0)
    assert score_set([truths[0], *[None] * 5], held, cfg) == {}
    assert score_novelty(truths[:2], subjects, cfg) == {"nearest_training": 0.0}
    assert score_novelty(truths[:1], subjects[1:], cfg)["nearest_training"] > 0


@pytest.mark.parametrize("fields", [("category", "counts", "size"), ("category",)])
def test_the_grammar_draws_what_is_near_to_a_condition(subjects: list[Subject], fields: tuple[Field, ...]):
    asked = describe_subject(subjects[0], fields)
    draw = grammar_source(tries=6)
    shape = draw(asked, 5)
    assert shape.name == draw(asked, 5).name
    assert shape.category == "Oven"
    said = shape.condition
    if asked.size is not None:
        assert (said.depth, said.width, said.height) == pytest.approx(asked.size, rel=0.25)
    with pytest.raises(ShapeError, match="no category"):
        draw(StructureCondition(), 5)
