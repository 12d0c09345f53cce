"""Repairs faults of source objects; every change is recorded."""
