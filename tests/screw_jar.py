"""A jar with a screw cap, as a package."""

from dataclasses import replace

import numpy as np

from artigen.types import Joint
from sim_export.geometry.hulls import box_hull
from sim_export.package import Inertial, Link, SimPackage
from sim_export.physics.inertia import mesh_inertial


def plain_link(name: str, label=None, hulls=(), inertial=None) -> Link:
    return Link(name=name, label=label, parts=(), visuals=(), hulls=hulls, inertial=inertial)


def screw_package() -> SimPackage:
    """A cap that rises 1 cm per turn on a plate: two joints in a row, the second following the first."""
    plate = box_hull(np.array([-0.2, -0.2, 0.0]), np.array([0.2, 0.2, 0.02]))
    cap = box_hull(np.array([-0.05, -0.05, 0.05]), np.array([0.05, 0.05, 0.09]))
    links = (
        plain_link("base"),
        plain_link("carrier", inertial=Inertial(mass=0.05, com=np.zeros(3), inertia=1e-5 * np.eye(3))),
        plain_link("link_0", "knob", (cap,), mesh_inertial(cap, 1000.0)),
        plain_link("link_1", "base", (plate,), mesh_inertial(plate, 1000.0)),
    )
    turn = Joint(
        name="joint_0",
        type="continuous",
        of_screw=True,
        parent="link_1",
        child="carrier",
        origin=np.zeros(3),
        axis=np.array([0.0, 0.0, 1.0]),
        friction=0.02,
        velocity=6.0,
    )
    travel = replace(
        turn,
        name="joint_0_travel",
        type="prismatic",
        parent="carrier",
        child="link_0",
        upper=0.05,
        friction=0.0,
        follows="joint_0",
        ratio=0.01 / (2 * np.pi),
    )
    bolt = replace(turn, name="joint_1", type="fixed", parent="base", child="link_1", friction=0.0)
    return SimPackage(
        name="jar", category="Bottle", visual="voxels", links=links, joints=(turn, travel, bolt)
    )
