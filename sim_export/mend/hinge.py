"""Moves a hinge inside its door to the nearer edge."""

from sim_export.checks.config import CheckConfig
from sim_export.checks.opening import door_panel, hinge_offset, panel_joints
from sim_export.mend.source import Source, leading_part, set_joint


def move_hinges(source: Source, cfg: CheckConfig) -> Source:
    """Moves every hinge that fails V203 across the panel to the edge of its door."""
    joints = [joint for joint in panel_joints(source.subject) if joint.type == "revolute"]
    panels = [(joint, door_panel(source.subject, joint)) for joint in joints]
    for joint, panel in panels:
        if panel is None:
            continue
        off, allowed = hinge_offset(panel, cfg)
        if off <= allowed:
            continue
        middle = (panel.low + panel.high) / 2.0
        nearer = panel.low if panel.hinge < middle else panel.high
        part = leading_part(source, joint.child)
        shift = (nearer - panel.hinge) * panel.across / source.asset.scale
        source = set_joint(
            source,
            part,
            f"{source.asset.parts[part].name}: its hinge was moved by {1e3 * off:.1f} mm to its edge",
            origin=source.asset.parts[part].joint.origin + shift,
        )
    return source
