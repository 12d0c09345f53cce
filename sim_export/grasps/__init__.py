"""Grasps of parallel grippers on handles and loose objects, found by geometry alone."""
