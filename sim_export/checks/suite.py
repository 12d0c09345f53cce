"""All checks from L0 to L2, in order of their ids."""

from collections.abc import Collection, Sequence
from pathlib import Path

from artigen.plugins import PluginError, find_plugins
from sim_export.checks.config import CheckConfig
from sim_export.checks.files import FILE_CHECKS
from sim_export.checks.geometry import GEOMETRY_CHECKS
from sim_export.checks.handles import HANDLE_CHECKS
from sim_export.checks.likeness import LIKENESS_CHECKS
from sim_export.checks.opening import OPENING_CHECKS
from sim_export.checks.registry import CheckSpec, run_specs
from sim_export.checks.subject import Subject
from sim_export.checks.sweep import SWEEP_CHECKS
from sim_export.report import CheckResult, Level

STATIC_LEVELS: tuple[Level, ...] = ("L0", "L1", "L2")
CHECKS: tuple[CheckSpec, ...] = tuple(
    sorted(
        (*FILE_CHECKS, *GEOMETRY_CHECKS, *LIKENESS_CHECKS, *SWEEP_CHECKS, *OPENING_CHECKS, *HANDLE_CHECKS),
        key=lambda spec: spec.id,
    )
)


def find_checks() -> tuple[CheckSpec, ...]:
    """`CHECKS`, and behind them those that extensions add.

    Raises:
        PluginError: If an extension cannot be loaded, or its check has an id that exists or a level above L2.
    """
    added = find_plugins("artigen.checks", CheckSpec)
    ids = {spec.id for spec in CHECKS}
    for plugin in added:
        if plugin.value.id in ids or plugin.value.level not in STATIC_LEVELS:
            raise PluginError(
                f"{plugin.origin}: check {plugin.value.id} of {plugin.value.level}: expected an id that is "
                f"not taken, such as ACME001, and one of {', '.join(STATIC_LEVELS)}"
            )
        ids.add(plugin.value.id)
    return (*CHECKS, *(plugin.value for plugin in added))


def run_checks(
    folder: Path | Subject,
    levels: Sequence[Level] = STATIC_LEVELS,
    cfg: CheckConfig | None = None,
    *,
    only: Collection[str] | None = None,
) -> tuple[CheckResult, ...]:
    """Runs the static checks of some levels on a package or an original PartNet-Mobility folder.

    Args:
        folder: The folder with ``mobility.urdf``, or what was read of it.
        levels: Which of L0, L1 and L2.
        cfg: Thresholds; the documented ones by default.
        only: Ids of the checks to run; all of these levels by default.
    """
    specs = [spec for spec in find_checks() if spec.level in levels and (only is None or spec.id in only)]
    subject = folder if isinstance(folder, Subject) else Subject(folder)
    return run_specs(specs, subject, CheckConfig() if cfg is None else cfg)
