"""Voxel fields back to parts, joints and a tree."""
