"""Writes the SRDF that SAPIEN loads beside the URDF: pairs of links that touch at rest.

Links connected by a joint never collide in SAPIEN, so only other pairs are listed. SAPIEN reads the first 31
pairs and requires the ``reason`` attribute.
"""

import xml.etree.ElementTree as ET
from itertools import combinations

import numpy as np

from sim_export.collision.contacts import HullSet, signed_distances
from sim_export.package import SimPackage

MAX_PAIRS = 31
TOUCH_DISTANCE = 1e-4
TOUCH_DEPTH = 1e-3


def touching_pairs(package: SimPackage) -> tuple[tuple[str, str], ...]:
    """Pairs of links without a joint between them that touch at rest.

    Touching means hulls less than 0.1 mm apart that overlap by at most 1 mm. A deeper overlap is a fault and
    is not hidden here.
    """
    joined = {frozenset((joint.parent, joint.child)) for joint in package.joints}
    sets = {link.name: HullSet(hulls=link.hulls) for link in package.links if link.hulls}
    pairs = []
    for first, second in combinations(sets, 2):
        if frozenset((first, second)) in joined:
            continue
        found = signed_distances(sets[first], sets[second], np.eye(4), np.eye(4), TOUCH_DISTANCE)
        if len(found.distance) and -TOUCH_DEPTH <= found.distance.min() <= TOUCH_DISTANCE:
            pairs.append((float(found.distance.min()), first, second))
    return tuple((first, second) for _, first, second in sorted(pairs)[:MAX_PAIRS])


def srdf_text(name: str, pairs: tuple[tuple[str, str], ...]) -> str:
    """The SRDF of the robot ``name``."""
    robot = ET.Element("robot", name=name)
    for first, second in pairs:
        ET.SubElement(robot, "disable_collisions", link1=first, link2=second, reason="Default")
    ET.indent(robot)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(robot, encoding="unicode") + "\n"
