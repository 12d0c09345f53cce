"""Repairs of faults that a source object has itself: what a person would do about them, each recorded."""
