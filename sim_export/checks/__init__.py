"""Static checks of a package folder: files (L0), geometry (L1) and motion (L2), without a simulator.

docs/reference/checks.md lists every check with its threshold, where it applies and why. `run_checks` and
`CHECKS` are in `sim_export.checks.suite`; they are not imported here, so that readers of packages can use the
URDF parser, and other processes the settings, without loading the checks or SciPy.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from sim_export.checks.config import CheckConfig

if TYPE_CHECKING:
    from sim_export.checks.registry import CheckSpec, Finding, run_check, run_specs
    from sim_export.checks.subject import Subject

__all__ = ["CheckConfig", "CheckSpec", "Finding", "Subject", "run_check", "run_specs"]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = "subject" if name == "Subject" else "registry"
    return getattr(import_module(f"{__name__}.{module}"), name)
