"""Metrics of generated and reconstructed objects."""
