"""The repairs and their order."""

from collections.abc import Callable
from dataclasses import replace

from sim_export.checks.config import CheckConfig
from sim_export.mend.apart import pull_apart
from sim_export.mend.bridge import bridge_islands
from sim_export.mend.handle import move_handles
from sim_export.mend.hinge import move_hinges
from sim_export.mend.source import Source
from sim_export.mend.travel import cut_travel

MENDS: tuple[tuple[str, str, Callable[[Source, CheckConfig], Source]], ...] = (
    ("V203", "hinge", move_hinges),
    ("V202", "apart", pull_apart),
    ("V204", "handle", move_handles),
    ("V107", "bridge", bridge_islands),
    ("V201", "travel", cut_travel),
)
"""Failed check, name and function of each repair; positions come before ranges."""


def mend_source(source: Source, cfg: CheckConfig | None = None) -> Source:
    """The object with its faults mended and a record of each; unchanged if it has none."""
    for check, name, mend in MENDS:
        mended = mend(source, cfg or CheckConfig())
        new = mended.records[len(source.records) :]
        if new:
            kept = mended.records[: len(source.records)]
            said = tuple(f"mend {name} ({check}): {record}" for record in new)
            source = replace(mended, records=(*kept, *said))
    return source
