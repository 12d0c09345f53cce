"""Static checks of a package folder: files (L0), geometry (L1) and motion (L2), without a simulator.

docs/reference/checks.md lists every check with its threshold, scope and rationale. `run_checks` and `CHECKS`
are in `sim_export.checks.suite`.
"""
