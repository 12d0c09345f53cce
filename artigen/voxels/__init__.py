"""Voxels: grids, 35-channel fields, voxelisation, where surface lies in cells, clean-up of drawn cells."""
