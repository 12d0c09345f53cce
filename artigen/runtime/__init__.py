"""Execution of jobs: supervised worker processes, Ray, journals, cores."""
