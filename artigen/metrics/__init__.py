"""Measurements of models: geometry, pictures, packages, and the reports of them."""
