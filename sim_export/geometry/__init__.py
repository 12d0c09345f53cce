"""Voxels of parts to closed meshes."""
