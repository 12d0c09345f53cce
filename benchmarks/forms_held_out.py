"""Forms of kinds that are not at hand, for reports only: nothing is developed by them."""

from itertools import pairwise

import manifold3d
import numpy as np
from form import Form, Solid, Triple, box, hinge, hollow, ring, rod, rounded, slide, spin, turned


def camera() -> Form:
    """A body with a lens barrel that turns, a shutter button and a flap behind."""
    body = rounded((0.05, 0.13, 0.08), 0.015)
    hump = rounded((0.04, 0.05, 0.02), 0.01).translate((0, 0, 0.078))
    lens = Solid.cylinder(0.05, 0.032, 0.034, 48) - Solid.cylinder(0.06, 0.026, 0.028, 48).translate(
        (0, 0, 0.006)
    )
    lens = lens.rotate((0, -90, 0)).translate((-0.025, 0, 0.04))
    button = Solid.cylinder(0.01, 0.007, 0.006, 24).translate((0, -0.045, 0.078))
    flap = rounded((0.003, 0.08, 0.05), 0.001).translate((0.0268, 0.0, 0.015))
    return Form(
        body=(body, hump),
        moving={
            "lens": hinge([lens], (-0.025, 0, 0.04), (1, 0, 0), 1.5),
            "button": slide([button], (0, 0, -1), 0.003),
            "flap": hinge([flap], (0.0268, 0.04, 0.04), (0, 0, 1), 1.5),
        },
    )


def fan() -> Form:
    """A foot, a head that turns, and a rotor of four bent blades in a cage of wires."""
    foot = turned([(0.0, 0.0), (0.11, 0.0), (0.1, 0.02), (0.015, 0.03), (0.012, 0.2), (0.0, 0.2)])
    at: Triple = (0.0, 0.0, 0.32)
    motor = (
        turned([(0.0, 0.0), (0.03, 0.0), (0.045, 0.03), (0.035, 0.1), (0.0, 0.11)])
        .rotate((0, 90, 0))
        .translate((0.03, 0, 0.32))
    )
    neck = rod((0.05, 0, 0.2), (0.05, 0, 0.3), 0.012)
    cage = [
        ring(r, 0.0025).rotate((0, 90, 0)).translate((x, 0, 0.32))
        for r, x in ((0.13, -0.02), (0.1, -0.05), (0.05, -0.055), (0.13, 0.02), (0.09, 0.035))
    ]
    for turn in np.arange(12) * np.pi / 6:
        c, s = float(np.cos(turn)), float(np.sin(turn))
        way = [(0.035, 0.03), (0.035, 0.09), (0.02, 0.13), (-0.02, 0.13), (-0.05, 0.1), (-0.055, 0.05)]
        cage += [
            rod((x0, r0 * c, 0.32 + r0 * s), (x1, r1 * c, 0.32 + r1 * s), 0.0025, 8)
            for (x0, r0), (x1, r1) in pairwise(way)
        ]
    hub = rod((-0.03, 0, 0.32), (0.03, 0, 0.32), 0.02)
    blade = (
        manifold3d.CrossSection.square((0.095, 0.05))
        .translate((0.015, -0.025))
        .extrude(0.002)
        .rotate((25, 0, 0))
        .rotate((0, -90, 0))
    )
    blades = [blade.rotate((90.0 * n, 0, 0)).translate((-0.01, 0, 0.32)) for n in range(4)]
    return Form(
        body=(foot,),
        moving={
            "head": hinge([motor, neck, *cage], (0.0, 0, 0.2), (0, 0, 1), 0.8),
            "rotor": spin([hub, *blades], at, (1, 0, 0), parent="head"),
        },
    )


def phone() -> Form:
    """A cradle with a receiver of a bent tube, and twelve buttons."""
    base = (rounded((0.2, 0.18, 0.06), 0.03) ^ rod((0.0, -1, -0.3), (0.0, 1, -0.3), 0.36, 96)).translate(
        (0, 0, 0.0)
    )
    keys = {}
    for row in range(4):
        for col in range(3):
            x, y = 0.04 - 0.025 * row, -0.005 + 0.025 * col
            z = float(np.sqrt(0.36**2 - x**2)) - 0.3
            keys[f"button_{row}{col}"] = slide(
                [rounded((0.016, 0.018, 0.012), 0.004).translate((x, y, min(z, 0.06) - 0.006))],
                (0, 0, -1),
                0.003,
            )
    bar = (
        ring(0.16, 0.014, 50.0)
        .rotate((0, 90, 0))
        .rotate((115, 0, 0))
        .translate((0, -0.06, -0.09))
        .rotate((0, 0, 90))
    )
    low = bar.bounding_box()
    bar = bar.translate((-(low[0] + low[3]) / 2, -0.06 - (low[1] + low[4]) / 2, 0.064 - low[2]))
    return Form(body=(base,), moving={"receiver": slide([bar], (0, 0, 1), 0.1), **keys})


def keyboard() -> Form:
    """A wedge with thirty sunken keys, each a hollow truncated pyramid."""
    wedge = (
        manifold3d.CrossSection([np.array([(-0.07, 0.0), (0.07, 0.0), (0.07, 0.025), (-0.07, 0.012)])])
        .extrude(0.42)
        .rotate((90, 0, 0))
        .translate((0, 0.21, 0))
    )
    wedge = wedge - box((-0.06, -0.2, 0.008), (0.06, 0.2, 1.0))
    square = manifold3d.CrossSection.square((0.028, 0.034), center=True)
    cap = square.extrude(0.016, scale_top=(0.75, 0.75)) - square.extrude(0.015, scale_top=(0.72, 0.72)).scale(
        (0.9, 0.9, 0.9)
    )
    keys = {
        f"key_{row}{col}": slide([cap.translate((x, y, 0.0085))], (0, 0, -1), 0.0)
        for row, x in enumerate((-0.042, 0.0, 0.042))
        for col, y in enumerate(np.linspace(-0.178, 0.178, 10))
    }
    keys = {
        name: slide([one.solids[0].translate((0, 0, 0.003))], (0, 0, -1), 0.002) for name, one in keys.items()
    }
    return Form(body=(wedge,), moving=keys)


def syringe() -> Form:
    """A thin tube with flanges and a needle, and a plunger of crossed ribs."""
    tube = turned([(0.008, 0.0), (0.009, 0.0), (0.009, 0.08), (0.018, 0.08), (0.018, 0.082), (0.008, 0.082)])
    tip = turned(
        [(0.0009, -0.012), (0.002, -0.012), (0.003, 0.0), (0.009, 0.0), (0.009, 0.0015), (0.0009, 0.0015)]
    )
    needle = Solid.cylinder(0.04, 0.0006, 0.0006, 12).translate((0, 0, -0.05))
    ribs = [
        box((-0.007, -0.0008, 0.03), (0.007, 0.0008, 0.11)),
        box((-0.0008, -0.007, 0.03), (0.0008, 0.007, 0.11)),
    ]
    plug = turned([(0.0, 0.02), (0.0078, 0.02), (0.0078, 0.03), (0.0, 0.03)])
    thumb = turned([(0.0, 0.11), (0.013, 0.11), (0.013, 0.113), (0.0, 0.113)])

    def laid(one: Solid) -> Solid:
        return one.rotate((0, 90, 0)).translate((0, 0, 0.018))

    return Form(
        body=[laid(one) for one in (tube, tip, needle)],
        moving={"plunger": slide([laid(one) for one in (*ribs, plug, thumb)], (-1, 0, 0), 0.018)},
    )


def eyeglasses() -> Form:
    """Two rims with lenses and a bridge, and two bent temples."""
    rims = [
        ring(0.025, 0.002).scale((1.15, 1.0, 1.0)).rotate((90, 0, 90)).translate((0, y, 0.03))
        for y in (-0.034, 0.034)
    ]
    lenses = [
        (Solid.sphere(0.08, 96) - Solid.sphere(0.078, 96)) ^ rod((0, 0, 0), (0.1, 0, 0), 0.0255, 48)
        for _ in range(2)
    ]
    lenses = [
        one.rotate((0, 0, 180)).translate((0.077, y, 0.03))
        for one, y in zip(lenses, (-0.034, 0.034), strict=True)
    ]
    bridge = ring(0.007, 0.002, 180.0).rotate((90, 0, 90)).translate((0, 0, 0.032))
    ends = [box((-0.002, y - 0.004, 0.036), (0.006, y + 0.004, 0.042)) for y in (-0.064, 0.064)]

    def temple(y: float) -> list[Solid]:
        return [
            box((0.0065, y - 0.001, 0.0365), (0.11, y + 0.001, 0.0415)),
            rod((0.109, y, 0.039), (0.14, y, 0.012), 0.0022),
        ]

    return Form(
        body=(*rims, *lenses, bridge, *ends),
        moving={
            "left": hinge(temple(-0.066), (0.006, -0.066, 0.039), (0, 0, 1), 1.4),
            "right": hinge(temple(0.066), (0.006, 0.066, 0.039), (0, 0, -1), 1.4),
        },
    )


def printer() -> Form:
    """A rounded box with a slot, a paper drawer, a scanner lid and a chute that folds down."""
    case = (
        rounded((0.36, 0.44, 0.2), 0.03)
        - box((-0.5, -0.17, 0.02), (0.1, 0.17, 0.07))
        - box((-0.5, -0.17, 0.1), (-0.05, 0.17, 0.17))
    )
    drawer = hollow((-0.185, -0.166, 0.024), (0.09, 0.166, 0.066), 0.003, open_to=(0, 0, 1))
    lid = rounded((0.36, 0.44, 0.035), 0.03) - rounded((0.34, 0.42, 0.03), 0.02).translate((0, 0, -0.003))
    chute = box((-0.184, -0.165, 0.102), (-0.181, 0.165, 0.168))
    return Form(
        body=(case,),
        moving={
            "drawer": slide([drawer], (-1, 0, 0), 0.2),
            "lid": hinge([lid.translate((0, 0, 0.202))], (0.18, 0, 0.203), (0, 1, 0), 1.2),
            "door": hinge([chute], (-0.1825, 0, 0.102), (0, -1, 0), 1.5),
        },
    )


def safe() -> Form:
    """A thick box, a door with a plug, a spoked wheel and a dial on it."""
    case = hollow((-0.2, -0.2, 0.0), (0.2, 0.2, 0.4), 0.03, open_to=(-1, 0, 0))
    door = [box((-0.225, -0.2, 0.0), (-0.202, 0.2, 0.4)), box((-0.203, -0.16, 0.04), (-0.19, 0.16, 0.36))]
    spokes = [
        rod((-0.245, 0, 0), (-0.245, float(0.05 * np.cos(t)), float(0.05 * np.sin(t))), 0.004).translate(
            (0, 0.05, 0.2)
        )
        for t in (0.0, 2.1, 4.2)
    ]
    spokes += [
        rod((-0.225, 0.05, 0.2), (-0.25, 0.05, 0.2), 0.012),
        ring(0.05, 0.005).rotate((0, 90, 0)).translate((-0.245, 0.05, 0.2)),
    ]
    dial = [rod((-0.225, -0.08, 0.2), (-0.245, -0.08, 0.2), 0.025, 48)]
    return Form(
        body=(case,),
        moving={
            "door": hinge(door, (-0.214, 0.2, 0.2), (0, 0, -1), 1.6),
            "wheel_handle": hinge(spokes, (-0.24, 0.05, 0.2), (1, 0, 0), 1.5, parent="door"),
            "dial": spin(dial, (-0.24, -0.08, 0.2), (1, 0, 0), parent="door"),
        },
    )


def door() -> Form:
    """A frame and a leaf with a cross of mouldings and levers on both sides."""
    frame = [box((-0.06, y, 0.0), (0.06, y + 0.06, 2.08)) for y in (-0.48, 0.42)] + [
        box((-0.06, -0.48, 2.02), (0.06, 0.48, 2.08))
    ]
    leaf = [box((-0.02, -0.415, 0.01), (0.02, 0.415, 2.01))]
    leaf += [box((-0.028, y, z), (0.028, y + 0.3, z + 0.8)) for y in (-0.35, 0.05) for z in (0.15, 1.05)]
    lever = [rod((-0.06, 0.36, 1.0), (0.06, 0.36, 1.0), 0.009)]
    lever += [rod((x, 0.36, 1.0), (x, 0.25, 1.005), 0.009) for x in (-0.06, 0.06)]
    return Form(
        body=frame,
        moving={
            "door": hinge(leaf, (-0.028, -0.415, 1.0), (0, 0, 1), 1.5),
            "handle": hinge(lever, (0.0, 0.36, 1.0), (1, 0, 0), 0.7, parent="door"),
        },
    )


def window() -> Form:
    """Two sashes with panes of a single sheet in a frame, one above the other, that slide."""
    frame = box((-0.06, -0.5, 0.0), (0.06, 0.5, 1.2)) - box((-1, -0.46, 0.04), (1, 0.46, 1.16))

    def sash(x: float, low: float) -> list[Solid]:
        rim = box((x, -0.455, low), (x + 0.03, 0.455, low + 0.57)) - box(
            (-1, -0.41, low + 0.045), (1, 0.41, low + 0.525)
        )
        return [rim, box((x + 0.014, -0.41, low + 0.045), (x + 0.016, 0.41, low + 0.525))]

    return Form(
        body=(frame,),
        moving={
            "lower": slide(sash(-0.035, 0.045), (0, 0, 1), 0.4),
            "upper": slide(sash(0.005, 0.585), (0, 0, -1), 0.4),
        },
    )


def lighter() -> Form:
    """A case whose hollow lid tips over a chimney with holes, and a wheel."""
    body = rounded((0.036, 0.012, 0.035), 0.004)
    chimney = rounded((0.022, 0.009, 0.014), 0.003).translate((0.002, 0, 0.034)) - rounded(
        (0.02, 0.007, 0.02), 0.002
    ).translate((0.002, 0, 0.036))
    lid = rounded((0.036, 0.012, 0.02), 0.004) - rounded((0.034, 0.0105, 0.02), 0.003).translate(
        (0, 0, -0.001)
    )
    wheel = [rod((-0.011, -0.0025, 0.042), (-0.011, 0.0025, 0.042), 0.0045)]
    return Form(
        body=(body, chimney),
        moving={
            "lid": hinge([lid.translate((0, 0, 0.0355))], (0.018, 0, 0.0353), (0, 1, 0), 2.0),
            "flint": spin(wheel, (-0.011, 0, 0.042), (0, 1, 0)),
        },
    )
