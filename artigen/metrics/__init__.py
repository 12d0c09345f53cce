"""Evaluation of models: geometry, pictures, packages, and reports."""
