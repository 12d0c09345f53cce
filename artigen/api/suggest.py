"""Proposes joints for mesh files and writes them beside these."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from artigen.api.convert import ConvertSettings


def suggest_files(sources: Sequence[Path], cfg: ConvertSettings | None = None) -> Iterator[str]:
    """Writes ``NAME.joints.json`` beside each mesh file, and says what it proposes, a line each.

    Raises:
        SourceError: If a file is no mesh file, has joints already, or shows nothing that moves.
    """
    from artigen.datasets.joints_file import joints_path, write_joints
    from artigen.datasets.mesh_scene import SUFFIXES
    from artigen.datasets.suggest_joints import suggest_joints
    from artigen.errors import SourceError

    cfg = cfg or ConvertSettings()
    for source in sources:
        target = joints_path(source)
        if not source.is_file() or source.suffix.lower() not in SUFFIXES:
            raise SourceError(f"{source}: is no mesh file, expected one of {', '.join(SUFFIXES)}")
        if target.exists():
            raise SourceError(f"{target}: is there already; remove it for a new proposal")
        said = suggest_joints(source, cfg.up or "y", cfg.front or "z")
        write_joints(target, said)
        for joint in said.joints:
            moves = "" if joint.type == "continuous" else f" by {joint.upper:.4g}"
            where = f"along {list(joint.axis)} at {list(joint.origin)}"
            yield f"{joint.part}: a {joint.label}, {joint.type}{moves} {where}"
        yield f"wrote {target}: correct it, then run `artigen convert {source}`"
