"""Writes the SRDF that SAPIEN loads beside the URDF: pairs of links whose contacts it ignores.

Links connected by a joint never collide in SAPIEN, so only other pairs are listed
(`sim_export.collision.ignored_pairs`). SAPIEN requires the ``reason`` attribute.
"""

import xml.etree.ElementTree as ET

MAX_PAIRS = 31
"""Pairs that SAPIEN accepts; further ones are left out."""


def srdf_text(name: str, pairs: tuple[tuple[str, str], ...]) -> str:
    """The SRDF of the robot ``name`` with the first of these pairs."""
    robot = ET.Element("robot", name=name)
    for first, second in pairs[:MAX_PAIRS]:
        ET.SubElement(robot, "disable_collisions", link1=first, link2=second, reason="Default")
    ET.indent(robot)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(robot, encoding="unicode") + "\n"
