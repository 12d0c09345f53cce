"""Readers of articulated objects, each giving an `Asset`; data sets, written and read."""

from artigen.datasets.shards import open_shards

__all__ = ["open_shards"]
