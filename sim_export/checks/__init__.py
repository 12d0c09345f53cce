"""Static checks of a package folder: files (L0), geometry (L1) and motion (L2), without a simulator."""

from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, run_check, run_specs
from sim_export.checks.subject import Subject
