"""Reads and writes packages on disk."""
