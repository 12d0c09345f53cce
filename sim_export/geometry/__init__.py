"""Meshes, hulls, solids and grids of triangles: closed meshes from voxels, distances, contacts."""
