"""Segmentation of voxel fields into parts, joints and a tree."""
