"""Static checks of a package folder: files (L0), geometry (L1) and motion (L2), without a simulator.

``docs/checks.md`` lists every check with its threshold, where it applies and why. The checks are not
imported here, so that readers of packages can share the URDF parser without loading them: take
`run_checks` and `CHECKS` from `sim_export.checks.suite`.
"""

from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, run_check, run_specs
from sim_export.checks.subject import Subject

__all__ = ["CheckConfig", "CheckSpec", "Finding", "Subject", "run_check", "run_specs"]
