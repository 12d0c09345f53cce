"""Topology of packages that can be simulated in one batch: links, joints, kinds of hulls.

Batched engines accept different objects only if just numbers differ: equal links and joints by name and
order, and equal numbers of collision shapes of the same kinds. `find_topology` hashes these properties.
"""

import hashlib
import json
from collections.abc import Sequence

from sim_export.geometry.primitives import find_primitive
from sim_export.package import Hull, SimPackage

DIGITS = 16
"""Number of hexadecimal digits of a hash."""


def find_topology(package: SimPackage) -> str:
    """Hash of a package's links, joints and kinds of hulls; equal for packages that fit into one batch."""
    links = [(link.name, link.label, hull_kinds(link.hulls)) for link in package.links]
    joints = [(joint.name, joint.type, joint.parent, joint.child, joint.follows) for joint in package.joints]
    text = json.dumps({"links": links, "joints": joints}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


def hull_kinds(hulls: Sequence[Hull]) -> list[str]:
    """``box``, ``cylinder`` or ``mesh`` of every hull."""
    shapes = [find_primitive(hull) for hull in hulls]
    return ["mesh" if shape is None else shape.kind for shape in shapes]
