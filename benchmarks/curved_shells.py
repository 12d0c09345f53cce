"""Objects of curved shells as URDFs, generated analytically: what convex decompositions find hardest.

python benchmarks/curved_shells.py out/shells    # one folder with a URDF and its meshes per object
"""

from collections.abc import Callable, Mapping
from pathlib import Path

import manifold3d
import numpy as np
import tyro
from form import ROUND, Form, Moving, Solid, Triple, box, ring, shell, turned, write_form


def toilet() -> Form:
    """An oval bowl on a waisted foot, a cistern, a seat and a lid that turn up."""
    profile = [
        (0.13, 0.0), (0.11, 0.06), (0.10, 0.14), (0.12, 0.20), (0.16, 0.27), (0.19, 0.34), (0.20, 0.38),
    ]  # fmt: skip
    bowl = shell(profile, 0.03, 0.15).scale((1.3, 1.0, 1.0))
    cistern = box((0.22, -0.2, 0.3), (0.4, 0.2, 0.75)) - box((0.235, -0.185, 0.32), (0.385, 0.185, 0.73))
    body = bowl + cistern + box((0.18, -0.12, 0.2), (0.38, 0.12, 0.375))
    seat = turned([(0.12, 0.384), (0.2, 0.384), (0.2, 0.404), (0.13, 0.404)]).scale((1.25, 1.0, 1.0))
    lid = turned([(0.0, 0.408), (0.2, 0.408), (0.19, 0.42), (0.0, 0.428)]).scale((1.25, 1.0, 1.0))
    hinge: Triple = (0.21, 0.0, 0.40)
    return Form(
        body=[body - box((0.0, -0.5, 0.38), (0.22, 0.5, 0.5))],
        moving={
            "seat": Moving(
                solids=[seat - box((0.215, -1, 0), (1, 1, 1))],
                type="revolute",
                origin=hinge,
                axis=(0, 1, 0),
                upper=1.3,
            ),
            "lid": Moving(
                solids=[lid - box((0.215, -1, 0), (1, 1, 1))],
                type="revolute",
                origin=hinge,
                axis=(0, 1, 0),
                upper=1.4,
            ),
        },
    )


def kettle() -> Form:
    """A bulging vessel with a spout and a bow, and a lid on a hinge."""
    heights = np.linspace(0.0, 0.18, 13)
    profile = [(float(0.1 - 4.0 * (h - 0.06) ** 2), float(h)) for h in heights]
    vessel = shell(profile, 0.006, 0.008)
    bow = ring(0.06, 0.008, 180.0).rotate((90, 0, 0)).rotate((0, 90, 0)).translate((0.08, 0, 0.1))
    spout = (Solid.cylinder(0.09, 0.02, 0.012, 24) - Solid.cylinder(0.1, 0.015, 0.008, 24)).rotate(
        (0, -45, 0)
    )
    spout = spout.translate((-0.075, 0, 0.08)) - turned([(0.0, 0.0), *profile, (0.0, 0.18)])
    lid = turned([(0.0, 0.182), (0.045, 0.182), (0.03, 0.195), (0.0, 0.2)])
    return Form(
        body=[vessel + spout + bow],
        moving={
            "lid": Moving(solids=[lid], type="revolute", origin=(0.045, 0, 0.182), axis=(0, 1, 0), upper=1.5)
        },
    )


def bin_with_lid() -> Form:
    """A bin with sloped walls and a domed lid."""

    def pyramid(half: float, low: float, high: float) -> Solid:
        square = manifold3d.CrossSection.square((2 * half, 1.4 * half), center=True)
        return square.extrude(high - low, scale_top=(1.35, 1.35)).translate((0, 0, low))

    body = pyramid(0.15, 0.0, 0.5) - pyramid(0.143, 0.008, 0.501)
    dome = Solid.sphere(0.3, ROUND).scale((1.0, 0.72, 0.4)) - Solid.sphere(0.29, ROUND).scale(
        (1.0, 0.71, 0.38)
    )
    dome = dome ^ box((-0.21, -0.146, 0.0), (0.21, 0.146, 1.0))
    dome = dome.translate((0, 0, 0.503 - float(dome.bounding_box()[2])))
    return Form(
        body=[body],
        moving={
            "lid": Moving(solids=[dome], type="revolute", origin=(0.2, 0, 0.51), axis=(0, 1, 0), upper=1.2)
        },
    )


def stapler() -> Form:
    """A base, and an arm that is a channel with a round back."""
    base = box((-0.08, -0.02, 0.0), (0.08, 0.02, 0.012)) + box((0.06, -0.008, 0.01), (0.074, 0.008, 0.034))
    back = Solid.cylinder(0.15, 0.018, 0.018, ROUND).rotate((0, 90, 0)) ^ box((-1, -1, 0), (1, 1, 1))
    hollow = Solid.cylinder(0.16, 0.015, 0.015, ROUND).rotate((0, 90, 0)) ^ box((-1, -1, 0), (1, 1, 1))
    arm = back - hollow.translate((-0.005, 0, 0))
    return Form(
        body=[base],
        moving={
            "arm": Moving(
                solids=[arm.translate((-0.075, 0, 0.028))],
                type="revolute",
                origin=(0.065, 0, 0.03),
                axis=(0, 1, 0),
                upper=0.5,
            )
        },
    )


def bread_bin() -> Form:
    """A half pipe with closed ends, and a quarter of a thin pipe that turns open before it."""

    def pipe(radius: float, wall: float, length: float) -> Solid:
        solid = Solid.cylinder(length, radius, radius, 64) - Solid.cylinder(
            length, radius - wall, radius - wall, 64
        )
        return solid.translate((0, 0, -length / 2)).rotate((90, 0, 0))

    half = pipe(0.15, 0.004, 0.4) ^ box((0.0, -1, 0.0), (1, 1, 1))
    ends = Solid.cylinder(0.006, 0.15, 0.15, 64).rotate((90, 0, 0)) ^ box((-1, -1, 0), (1, 1, 1))
    floor = box((-0.15, -0.2, -0.006), (0.15, 0.2, 0.0))
    body = half + ends.translate((0, 0.2, 0)) + ends.translate((0, -0.194, 0)) + floor
    door = pipe(0.142, 0.003, 0.36) ^ box((-1, -1, 0.004), (-0.003, 1, 1))
    return Form(
        body=[body],
        moving={"door": Moving(solids=[door], type="revolute", origin=(0, 0, 0), axis=(0, 1, 0), upper=1.4)},
    )


def toaster() -> Form:
    """A rounded housing with two slots, and a lever that slides down."""
    outline = manifold3d.CrossSection.square((0.20, 0.09), center=True).offset(
        0.04, manifold3d.JoinType.Round, circular_segments=32
    )
    body = outline.extrude(0.18)
    inner = (
        outline.offset(-0.004, manifold3d.JoinType.Round, circular_segments=32)
        .extrude(0.17)
        .translate((0, 0, 0.006))
    )
    body -= inner ^ box((-0.2, -0.2, 0.01), (0.2, 0.2, 0.172))
    for y in (-0.03, 0.03):
        well = box((-0.1, y - 0.017, 0.03), (0.1, y + 0.017, 0.2)) - box(
            (-0.097, y - 0.014, 0.033), (0.097, y + 0.014, 0.3)
        )
        body = (
            body
            - box((-0.1, y - 0.017, 0.03), (0.1, y + 0.017, 0.2))
            + (well ^ box((-1, -1, 0), (1, 1, 0.18)))
        )
    lever = box((-0.17, -0.02, 0.12), (-0.146, 0.02, 0.135))
    return Form(
        body=[body],
        moving={
            "lever": Moving(solids=[lever], type="prismatic", origin=(0, 0, 0), axis=(0, 0, -1), upper=0.08)
        },
    )


OBJECTS: Mapping[str, Callable[[], Form]] = {
    "toilet": toilet, "kettle": kettle, "bin": bin_with_lid, "stapler": stapler, "bread_bin": bread_bin,
    "toaster": toaster,
}  # fmt: skip


def main(out: tyro.conf.Positional[Path]) -> None:
    """Writes all objects."""
    for name, make in OBJECTS.items():
        print(write_form(make(), out / name, name))


if __name__ == "__main__":
    tyro.cli(main)
