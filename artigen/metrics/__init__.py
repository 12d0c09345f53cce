"""Measures of generated and reconstructed objects."""
