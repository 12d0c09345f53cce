"""Convex collision hulls of links: candidates, selection, clearance, additions."""
