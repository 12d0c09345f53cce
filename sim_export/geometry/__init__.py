"""Closed meshes from voxels of parts."""
