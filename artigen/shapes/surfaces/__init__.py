"""Finishes, palettes and textures."""
