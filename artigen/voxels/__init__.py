"""Voxels: grids, 35-channel fields, voxelisation, surface position in cells, clean-up of sampled cells."""
