"""Snaps nearly regular values to regular ones; recorded in the asset's notes.

Networks and voxels give axes that are a degree or two off; furniture is built square. An axis that is
farther off than the tolerances is taken as intended and kept. Limits need no snapping:
`artigen.voxels.segmentation.segment` states ranges from zero, and full turns of continuous joints.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from artigen.types import Asset, Joint, Part
from artigen.voxels.fields import canonical_origin

AXIS_DEGREES = 1.0
"""An axis closer than this to a principal direction becomes that direction."""
CENTER_OFFSET = 0.25 / 64.0
"""The axis of a continuous joint that passes its part's box centre within this many unit lengths
is moved through the centre."""
SIGMAS = 3.0
"""Where the standard error of a vote is known, the tolerance is at least this multiple of it."""
MOST_DEGREES = 8.0
"""Largest angle by which an axis is turned, however uncertain it is."""
MOST_OFFSET = 1.5 / 64.0
"""Largest distance, in unit lengths, by which an axis is moved, however uncertain it is."""


def regularise(asset: Asset, errors: Sequence[tuple[float, float]] | None = None) -> Asset:
    """Snaps axes to principal directions and continuous axes to box centres; one note per change.

    Args:
        errors: Standard errors of each part's axis (radians) and axis line (unit lengths), where known.
    """
    errors = errors if errors is not None else [(0.0, 0.0)] * len(asset.parts)
    parts, notes = [], []
    for part, (axis_error, line_error) in zip(asset.parts, errors, strict=True):
        degrees = min(max(AXIS_DEGREES, SIGMAS * float(np.degrees(axis_error))), MOST_DEGREES)
        offset = min(max(CENTER_OFFSET, SIGMAS * line_error), MOST_OFFSET)
        part, new = _regular_part(part, degrees, offset)
        parts.append(part)
        notes += new
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
