"""Voxel fields to parts, joints and a tree."""
