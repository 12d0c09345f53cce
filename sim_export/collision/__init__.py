"""Convex collision hulls: candidates, selection, clearance, additions."""
