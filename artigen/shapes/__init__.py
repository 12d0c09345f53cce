"""Procedural articulated objects with exact truth: shapes drawn from a grammar, made of convex primitives."""
