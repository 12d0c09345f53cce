"""Convex hulls of surfaces, those of sources or of solids: boxes, and pieces that take no free space."""
