"""Readers of articulated objects: one function per source, each giving an `Asset`."""
