"""Compares the URDF of a PartNet-Mobility folder with its annotation, which takes precedence.

The URDF is an export of the annotation that redistributors have sometimes edited. It is used to find meshes
and compared with the annotation, but not trusted.
"""

from pathlib import Path

import numpy as np

from artigen.datasets.partnet_annotation import SourceNode
from artigen.datasets.partnet_joints import joint_kind
from artigen.datasets.urdf_file import SourceUrdf
from artigen.errors import SourceError
from artigen.files.urdf import UrdfJoint

EXPECTED_TYPES: dict[str, tuple[str, ...]] = {
    "fixed": ("fixed",),
    "revolute": ("revolute",),
    "prismatic": ("prismatic",),
    "continuous": ("continuous",),
    "screw": ("continuous", "revolute", "prismatic"),
}


def compare_urdf(nodes: tuple[SourceNode, ...], urdf: SourceUrdf) -> list[str]:
    """The differences of the URDF from mobility_v2.json, which is used."""
    joints = {joint.child: joint for joint in urdf.joints}
    changed = [
        change
        for node in nodes
        if node.parent != -1 and (change := _compare_joint(node, joints.get(f"link_{node.id}")))
    ]
    notes = []
    if changed:
        notes.append(f"the URDF differs from mobility_v2.json, which is used: {', '.join(changed)}")
    known = {f"link_{node.id}" for node in nodes} | {"base"}
    known |= {f"link_{node.id}_helper" for node in nodes if node.rotates}
    extra = [link for link in urdf.links if link not in known]
    if extra:
        notes.append(f"the URDF has links that mobility_v2.json does not know: {', '.join(extra)}")
    base = next(node for node in nodes if node.parent == -1)
    expected = urdf.T_base_link.get(f"link_{base.id}")
    if expected is not None:
        meshes = [visual for visual in urdf.visuals if visual.kind == "mesh"]
        shifted = [v.link for v in meshes if not np.allclose(urdf.place(v), expected, atol=1e-4)]
        if shifted:
            notes.append(
                f"{len(shifted)} visuals are shifted by the URDF ({', '.join(dict.fromkeys(shifted))}); "
                "the places in their mesh files are used"
            )
    return notes


def _compare_joint(node: SourceNode, joint: UrdfJoint | None) -> str:
    kind = joint_kind(node)
    if joint is None:
        return f"link_{node.id} is missing"
    if joint.type not in EXPECTED_TYPES[kind]:
        return f"link_{node.id} is {joint.type} instead of {kind}"
    if kind in ("revolute", "prismatic"):
        span = abs(node.b - node.a) if kind == "prismatic" else np.radians(abs(node.b - node.a))
        said = (joint.upper or 0.0) - (joint.lower or 0.0)
        if abs(said - span) > 0.01 * span:
            return f"link_{node.id} spans {said:.4g} instead of {span:.4g}"
    return ""


def check_scales(urdf: SourceUrdf, path: Path) -> None:
    """Raises `SourceError` if the URDF scales a mesh, since the annotation has one unit of length."""
    for visual in urdf.visuals:
        if visual.scale != (1.0, 1.0, 1.0):
            scale = " ".join(f"{value:g}" for value in visual.scale)
            raise SourceError(
                f"{path}: visual {visual.name!r} of link {visual.link!r}: mesh scale {scale!r}, "
                "expected 1 1 1"
            )
