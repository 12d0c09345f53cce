"""`RasterConfig`: pixel filter and memory limits of the rasteriser."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class RasterConfig:
    """Filter, cut-offs and working memory of the rasteriser; the defaults are those of TRELLIS."""

    filter_variance: float = 0.1
    """Variance (square pixels) that is added to every footprint; opacities fall so that its sum stays.
    Raise it when edges shimmer."""
    max_alpha: float = 0.99
    """Largest coverage of a pixel by one splat."""
    min_alpha: float = 1.0 / 255.0
    """Least coverage of a pixel by a splat that counts; lower it for finer tails, at more time."""
    min_transmittance: float = 1e-4
    """A tile is finished when the transmittance of all its pixels has fallen to this."""
    near: float = 0.01
    """Least depth of a splat's centre that is drawn (scene units)."""
    tile: int = 8
    """Edge of a tile in pixels."""
    fragments: int = 1 << 19
    """Pairs of a splat and a pixel computed at once; GPUs are faster with 32 times as many."""
    pairs: int = 1 << 22
    """Pairs of a splat and a tile listed at once, or those of one row of tiles where that is more."""

    def __post_init__(self) -> None:
        if not 0 < self.min_alpha < self.max_alpha < 1:
            raise ValueError(
                f"rasteriser: min_alpha {self.min_alpha} and max_alpha {self.max_alpha}, "
                "expected 0 < min_alpha < max_alpha < 1"
            )
        if not 0 <= self.min_transmittance < 1:
            raise ValueError(
                f"rasteriser: min_transmittance is {self.min_transmittance}, expected 0 to below 1"
            )
        if not (self.filter_variance >= 0 and self.near > 0):
            raise ValueError(
                f"rasteriser: filter_variance {self.filter_variance} and near {self.near}, "
                "expected at least 0 and above 0"
            )
        if not 1 <= self.tile <= 64:
            raise ValueError(f"rasteriser: tile is {self.tile} pixels, expected 1 to 64")
        if min(self.fragments, self.pairs) < 1:
            raise ValueError(
                f"rasteriser: fragments {self.fragments} and pairs {self.pairs}, expected at least 1"
            )
