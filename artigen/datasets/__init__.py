"""Objects from elsewhere and for elsewhere: readers of articulated objects, each giving an `Asset`; data sets."""

from artigen.datasets.shards import open_shards

__all__ = ["open_shards"]
