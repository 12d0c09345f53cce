"""Feature extractors: the pyramid's laws, and one interface for it and DINOv2."""

from pathlib import Path

import pytest
import torch
from encoder_files import DINO, write_dinov2

from artigen.appearance.extractors import ExtractorConfig, make_extractor
from artigen.appearance.features import BASE, FeatureExtractor, PyramidFeatures
from artigen.errors import SourceError
from artigen.models.public_encoders import load_dinov2


def disc(color: tuple[float, float, float], size: int = 32) -> torch.Tensor:
    """A premultiplied picture of a disc."""
    steps = torch.arange(size) - (size - 1) / 2
    alpha = ((steps[:, None] ** 2 + steps**2) < (0.4 * size) ** 2).float()
    return torch.cat([torch.tensor(color)[:, None, None] * alpha, alpha[None]])[None]


def test_the_background_does_not_mix_into_colours():
    color = (0.8, 0.3, 0.1)
    picture = disc(color)
    maps = PyramidFeatures(20)(picture)
    inside = picture[0, 3] > 0
    for level in (slice(0, 3), slice(5, 8), slice(10, 13)):
        found = maps[0, level][:, inside]
        torch.testing.assert_close(found, torch.tensor(color)[:, None].expand_as(found), atol=1e-5, rtol=0)
    assert maps.shape == (1, 20, 32, 32)


def test_the_pyramid_is_the_same_every_time_and_sees_differences():
    one, two = (PyramidFeatures(24)(disc((0.8, 0.3, 0.1))) for _ in range(2))
    assert torch.equal(one, two)
    other = PyramidFeatures(24)(disc((0.1, 0.3, 0.8)))
    assert ((one - other).abs().amax(dim=(0, 2, 3)) > 1e-3)[BASE:].all()
    turned = PyramidFeatures(24)(disc((0.8, 0.3, 0.1)).flip(3))
    torch.testing.assert_close(turned[:, :3].flip(3), one[:, :3])
    torch.testing.assert_close(turned[:, 3].flip(2), -one[:, 3])
    with pytest.raises(ValueError, match="at least 16"):
        PyramidFeatures(8)


def test_extractors_answer_to_one_interface(tmp_path: Path):
    write_dinov2(tmp_path)
    for extractor in (make_extractor(ExtractorConfig(channels=18)), load_dinov2(tmp_path, DINO)):
        assert isinstance(extractor, FeatureExtractor)
        maps = extractor(disc((0.5, 0.5, 0.5)))
        assert maps.shape[1] == extractor.channels
        assert extractor.name.endswith(str(extractor.channels))
    with pytest.raises(SourceError, match="folder"):
        make_extractor(ExtractorConfig(name="dinov2"))
    with pytest.raises(SourceError, match=r"width=48, .* expected .*width=1024"):
        make_extractor(ExtractorConfig(name="dinov2", folder=tmp_path))
