"""The exact sample cabinet with resistances that hold against a tilt of 5 degrees."""

from dataclasses import replace

from sample_packages import SAMPLE_PARTS, build_package

from sim_export.package import SimPackage

RESISTANCE = {"joint_0": (12.0, 8.0), "joint_1": (4.0, 0.4), "joint_2": (0.04, 1e-4), "joint_3": (9.0, 5.0)}
"""Friction (N or N m) and damping of joints."""


def braced_cabinet() -> SimPackage:
    """The package."""
    package = build_package(SAMPLE_PARTS)
    for name, (friction, damping) in RESISTANCE.items():
        package = with_joint(package, name, friction=friction, damping=damping)
    return package


def with_joint(package: SimPackage, name: str, **changes: object) -> SimPackage:
    """A package with a joint changed."""
    joints = tuple(replace(joint, **changes) if joint.name == name else joint for joint in package.joints)
    return replace(package, joints=joints)


def with_link(package: SimPackage, name: str, **changes: object) -> SimPackage:
    """A package with a link changed."""
    links = tuple(replace(link, **changes) if link.name == name else link for link in package.links)
    return replace(package, links=links)
