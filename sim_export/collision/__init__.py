"""Convex hulls: offered, chosen, cut free, added."""
