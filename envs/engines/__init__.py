"""Packages in other engines, each engine in its own process."""
