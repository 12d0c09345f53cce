"""Packages at work in SAPIEN: loading, gymnasium environments, and the validation suite."""
