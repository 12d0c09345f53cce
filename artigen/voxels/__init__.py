"""Voxels: grids, 35-channel fields, voxelisation, segmentation, clean-up of drawn cells."""
