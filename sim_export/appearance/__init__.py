"""Textures on part meshes."""
