"""Photographs of several objects along a wall."""
