"""Readers of articulated objects, each returning an `Asset`; writing and reading of data sets."""

from artigen.datasets.shards import open_shards

__all__ = ["open_shards"]
