"""Snaps nearly regular values to regular ones; recorded in the asset's notes.

Networks and voxels give axes that are a degree or two off; furniture is built square. Whatever is
farther from square than the tolerances is taken as meant and left alone. Limits need no snapping:
`artigen.voxels.segmentation.segment` states ranges from zero, and full turns of continuous joints.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from artigen.types import Asset, Joint, Part
from artigen.voxels.fields import canonical_origin


@dataclass(frozen=True, kw_only=True)
class RegulariseConfig:
    """Tolerances of the snapping."""

    axis_degrees: float = 1.0
    """An axis closer than this to a principal direction becomes that direction."""
    center_offset: float = 0.25 / 64.0
    """The axis of a continuous joint that passes its part's box centre within this many unit lengths
    is moved through the centre."""
    sigmas: float = 3.0
    """Where the standard error of a vote is known, its tolerance is at least this many of them."""
    most_degrees: float = 8.0
    """However uncertain, no axis is turned by more than this."""
    most_offset: float = 1.5 / 64.0
    """However uncertain, no axis is moved by more than this."""

    def __post_init__(self) -> None:
        if not 0 <= self.axis_degrees <= self.most_degrees < 45:
            raise ValueError(
                f"axis_degrees {self.axis_degrees}, most_degrees {self.most_degrees}: expected 0 <= first <= "
                "second < 45"
            )
        if not 0 <= self.center_offset <= self.most_offset:
            raise ValueError(
                f"center_offset {self.center_offset}, most_offset {self.most_offset}: "
                "expected 0 <= first <= second"
            )
        if self.sigmas < 0:
            raise ValueError(f"sigmas is {self.sigmas}, expected 0 or more")


def regularise(
    asset: Asset,
    cfg: RegulariseConfig | None = None,
    *,
    errors: Sequence[tuple[float, float]] | None = None,
) -> Asset:
    """Snaps axes to principal directions and continuous axes to box centres; one note per change.

    Args:
        asset: What to regularise.
        cfg: Tolerances; the defaults when None.
        errors: Standard errors of each part's axis (radians) and axis line (unit lengths), where known.
    """
    cfg = cfg or RegulariseConfig()
    errors = errors if errors is not None else [(0.0, 0.0)] * len(asset.parts)
    parts, notes = [], []
    for part, (axis_error, line_error) in zip(asset.parts, errors, strict=True):
        degrees = min(max(cfg.axis_degrees, cfg.sigmas * float(np.degrees(axis_error))), cfg.most_degrees)
        offset = min(max(cfg.center_offset, cfg.sigmas * line_error), cfg.most_offset)
        part, said = _regular_part(part, degrees, offset)
        parts.append(part)
        notes += said
    return replace(asset, parts=tuple(parts), notes=asset.notes + tuple(notes))


def _regular_part(part: Part, degrees: float, offset: float) -> tuple[Part, list[str]]:
    if part.joint.type == "fixed":
        return part, []
    notes = []
    axis, turned = _snapped_axis(part.joint, degrees)
    if turned > 1e-6:
        notes.append(
            f"{part.name}: axis turned by {np.degrees(turned):.2f} degrees onto a principal direction"
        )
    joint = replace(part.joint, axis=axis)
    origin = canonical_origin(replace(part, joint=joint))
    if joint.type == "continuous":
        moved = np.linalg.norm(origin - part.box[0])
        if 1e-9 < moved <= offset:
            notes.append(f"{part.name}: axis moved by {moved:.4f} units through the box centre")
            origin = part.box[0]
    return replace(part, joint=replace(joint, origin=origin)), notes


def _snapped_axis(joint: Joint, degrees: float) -> tuple[np.ndarray, float]:
    """The axis or its principal direction, and the angle between them in radians."""
    nearest = int(np.abs(joint.axis).argmax())
    principal = np.eye(3)[nearest] * np.sign(joint.axis[nearest])
    angle = float(np.arctan2(np.linalg.norm(np.delete(joint.axis, nearest)), abs(joint.axis[nearest])))
    return (principal, angle) if angle <= np.radians(degrees) else (joint.axis, 0.0)
