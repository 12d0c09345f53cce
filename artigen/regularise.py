"""Snaps what is almost regular: a stage of its own, recorded in the asset's notes.

Networks and voxels give axes that are a degree or two off; furniture is built square. Whatever is
farther from square than the tolerances is taken as meant and left alone.
"""

from dataclasses import dataclass, replace

import numpy as np

from artigen.fields import canonical_origin
from artigen.types import Asset, Joint, Part


@dataclass(frozen=True, kw_only=True)
class RegulariseConfig:
    """Tolerances of the snapping."""

    axis_degrees: float = 1.0
    """An axis closer than this to a principal direction becomes that direction."""
    knob_offset: float = 0.25 / 64.0
    """The axis of a continuous joint that passes its part's box centre within this many unit lengths
    is moved through the centre."""
    sigmas: float = 3.0
    """Where the uncertainty of a vote is known, the tolerances grow by this many standard errors."""
    most_degrees: float = 8.0
    """However uncertain, no axis is turned by more than this."""

    def __post_init__(self) -> None:
        if not 0 <= self.axis_degrees < 45:
            raise ValueError(f"axis_degrees is {self.axis_degrees}, expected 0 to 45")
        if self.knob_offset < 0:
            raise ValueError(f"knob_offset is {self.knob_offset}, expected 0 or more")


def regularise(asset: Asset, cfg: RegulariseConfig | None = None) -> Asset:
    """Snaps axes and knob centres within tolerance; one note per change."""
    cfg = cfg or RegulariseConfig()
    parts, notes = [], []
    for part in asset.parts:
        part, said = _regular_part(part, cfg)
        parts.append(part)
        notes += said
    return replace(asset, parts=tuple(parts), notes=asset.notes + tuple(notes))


def _regular_part(part: Part, cfg: RegulariseConfig) -> tuple[Part, list[str]]:
    joint = part.joint
    if joint.type == "fixed":
        return part, []
    notes = []
    axis, turned = _snapped_axis(joint, cfg.axis_degrees)
    if turned > 1e-6:
        notes.append(
            f"{part.name}: axis turned by {np.degrees(turned):.2f} degrees onto a principal direction"
        )
    joint = replace(joint, axis=axis)
    origin = canonical_origin(replace(part, joint=joint))
    if joint.type == "continuous":
        moved = np.linalg.norm(origin - part.box[0])
        if 1e-9 < moved <= cfg.knob_offset:
            notes.append(f"{part.name}: axis moved by {moved:.4f} units through the box centre")
            origin = part.box[0]
    return replace(part, joint=replace(joint, origin=origin)), notes


def _snapped_axis(joint: Joint, degrees: float) -> tuple[np.ndarray, float]:
    """The axis or its principal direction, and the angle between them in radians."""
    nearest = int(np.abs(joint.axis).argmax())
    principal = np.eye(3)[nearest] * np.sign(joint.axis[nearest])
    angle = float(np.arctan2(np.linalg.norm(np.delete(joint.axis, nearest)), abs(joint.axis[nearest])))
    return (principal, angle) if angle <= np.radians(degrees) else (joint.axis, 0.0)
