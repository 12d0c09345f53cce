"""A drawer with a bar on two posts, as exact boxes, in a fixed body."""

import numpy as np

from artigen.types import Joint, PartLabel
from sim_export.geometry.hulls import box_hull
from sim_export.package import HandleAnnotation, Hull, Link, Mesh, SimPackage, Visual
from sim_export.physics.inertia import combine, mesh_inertial

FRONT = (-0.02, 0.0)
"""Where the front board begins and ends along x."""
TRAVEL = 0.2


def pulled_drawer(width: float = 0.012, *extra: Hull) -> SimPackage:
    """A drawer whose bar is ``width`` metres high and stands 30 mm before the front.

    Args:
        width: Height of the bar, metres.
        extra: More hulls of the body.
    """
    bar = box_hull(np.array([-0.06, -0.1, -width / 2]), np.array([-0.05, 0.1, width / 2]))
    posts = [
        box_hull(np.array([-0.05, y - 0.005, -0.005]), np.array([-0.02, y + 0.005, 0.005]))
        for y in (-0.09, 0.09)
    ]
    front = box_hull(np.array([FRONT[0], -0.25, -0.1]), np.array([FRONT[1], 0.25, 0.1]))
    tray = box_hull(np.array([0.0, -0.2, -0.09]), np.array([0.3, 0.2, -0.08]))
    body = box_hull(np.array([0.31, -0.25, -0.4]), np.array([0.35, 0.25, 0.1]))
    joint = Joint(
        type="prismatic", axis=np.array([-1.0, 0.0, 0.0]), upper=TRAVEL, friction=2.0, damping=1.0,
        name="joint_0", parent="body", child="link_0",
    )  # fmt: skip
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    handle = HandleAnnotation(
        link="link_0", part="pull", corners=np.array([-0.04, 0.0, 0.0]) + signs * [0.02, 0.1, width / 2],
        normal=np.array([-1.0, 0.0, 0.0]), grasp_line=np.array([[-0.055, -0.08, 0.0], [-0.055, 0.08, 0.0]]),
        width=width, clearance=0.03, opening_direction=np.array([-1.0, 0.0, 0.0]), gapart="line_fixed_handle",
    )  # fmt: skip
    drawer = _link("link_0", "drawer", (front, tray), (bar, *posts))
    return SimPackage(
        name="pulled", category="Thing", visual="exact",
        links=(_link("body", "base", (body, *extra)), drawer),
        joints=(joint,), handles=(handle,),
    )  # fmt: skip


def _link(name: str, label: PartLabel, own: tuple[Hull, ...], pull: tuple[Hull, ...] = ()) -> Link:
    named = [(hull, label, label) for hull in own] + [(hull, "pull", "handle") for hull in pull]
    visuals = tuple(
        Visual(
            name=f"{kind}_{name}_{number}",
            part=part,
            label=kind,
            mesh=Mesh(vertices=hull.vertices, faces=hull.faces),
        )
        for number, (hull, part, kind) in enumerate(named)
    )
    hulls = (*own, *pull)
    inertial = combine([mesh_inertial(hull, 600.0) for hull in hulls])
    parts = (label, "pull") if pull else (label,)
    return Link(name=name, label=label, parts=parts, visuals=visuals, hulls=hulls, inertial=inertial)
