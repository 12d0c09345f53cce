"""`pin_carriers`: a collision pin for the link between the two joints of a screw.

Loaders want collision on every link. The pin lies on the screw's axis inside of what the screw moves, and
engines let no link collide with those it is joined to, so nothing ever meets it.
"""

from collections.abc import Sequence
from dataclasses import replace

from artigen.types import Joint
from sim_export.geometry.primitives import PrimitiveShape, place_along, primitive_hull
from sim_export.package import Link

RADIUS = 0.002
LENGTH = 0.004
"""Metres."""


def pin_carriers(links: Sequence[Link], joints: Sequence[Joint]) -> tuple[Link, ...]:
    """Links with a pin on every screw's carrier, whose centre of mass moves there.

    The pin's middle is the point on the axis beside the centre of mass of what the screw moves.
    """
    by_name = {link.name: link for link in links}
    pinned = {}
    for joint in joints:
        moved, carrier = by_name[joint.child].inertial, by_name[joint.parent]
        if joint.follows is None or carrier.hulls or moved is None or carrier.inertial is None:
            continue
        middle = joint.origin + joint.axis * float(joint.axis @ (moved.com - joint.origin))
        shape = PrimitiveShape(
            kind="cylinder", sizes=(RADIUS, LENGTH), T_object_shape=place_along(joint.axis, middle)
        )
        inertial = replace(carrier.inertial, com=middle)
        pinned[carrier.name] = replace(carrier, hulls=(primitive_hull(shape),), inertial=inertial)
    return tuple(pinned.get(link.name, link) for link in links)
