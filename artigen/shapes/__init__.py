"""Procedural articulated objects with exact ground truth, sampled from a grammar and built of convex
primitives."""
