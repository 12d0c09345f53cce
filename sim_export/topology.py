"""Topology of packages, equal for those that fit into one batch: links, joints, kinds of hulls.

Engines that step many worlds at once take different objects where only numbers differ: the same links and
joints by name and order, and as many collision shapes of the same kinds. `find_topology` is a hash of these.
"""

import hashlib
import json
from collections.abc import Sequence

from sim_export.geometry.primitives import find_primitive
from sim_export.package import Hull, SimPackage

DIGITS = 16
"""Hexadecimal digits of a hash."""


def find_topology(package: SimPackage) -> str:
    """The hash of a package's links, joints and kinds of hulls; equal for packages that fit in one batch."""
    links = [(link.name, link.label, hull_kinds(link.hulls)) for link in package.links]
    joints = [(joint.name, joint.type, joint.parent, joint.child, joint.mimic) for joint in package.joints]
    text = json.dumps({"links": links, "joints": joints}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


def hull_kinds(hulls: Sequence[Hull]) -> list[str]:
    """``box``, ``cylinder`` or ``mesh`` of every hull."""
    shapes = [find_primitive(hull) for hull in hulls]
    return ["mesh" if shape is None else shape.kind for shape in shapes]
