"""Forms of kinds that are not at hand, which may be looked at while conversion is developed."""

from itertools import pairwise

import manifold3d
import numpy as np
from form import Form, Solid, box, hinge, hollow, ring, rod, rounded, shell, slide, spin, turned


def coffee_machine() -> Form:
    """A column with an overhang above a jug, a drip tray that pulls out, a lid and a dial."""
    foot = hollow((-0.16, -0.1, 0.0), (0.12, 0.1, 0.03), 0.004, open_to=(-1, 0, 0))
    column = hollow((0.03, -0.1, 0.03), (0.12, 0.1, 0.3), 0.004, open_to=(0, 0, 1))
    head = rounded((0.14, 0.19, 0.07), 0.05).translate((-0.05, 0, 0.23)) - box((0.03, -1, 0), (1, 1, 1))
    jug = shell([(0.04, 0.0), (0.055, 0.02), (0.06, 0.06), (0.05, 0.11), (0.045, 0.12)], 0.003, 0.004)
    bow = ring(0.03, 0.005, 180.0).rotate((90, 0, 0)).rotate((0, 0, 90)).translate((0, -0.055, 0.06))
    jug, bow = jug.translate((-0.06, 0, 0.034)), bow.translate((-0.06, 0, 0.034))
    tray = hollow((-0.158, -0.094, 0.005), (0.02, 0.094, 0.025), 0.002, open_to=(0, 0, 1))
    lid = rounded((0.088, 0.196, 0.008), 0.02).translate((0.076, 0, 0.301))
    dial = rod((-0.12, 0, 0.26), (-0.138, 0, 0.26), 0.018)
    return Form(
        body=(foot, column, head),
        moving={
            "tray": slide([tray], (-1, 0, 0), 0.12),
            "lid": hinge([lid], (0.12, 0, 0.303), (0, 1, 0), 1.4),
            "knob": hinge([dial], (-0.12, 0, 0.26), (1, 0, 0), 4.0),
            "jug": slide([jug, bow], (-1, 0, 0), 0.15),
        },
    )


def globe() -> Form:
    """A thin ball that spins on a tilted axis in an arc on a foot."""
    tilt, at = 23.4, (0.0, 0.0, 0.2)
    ball = (Solid.sphere(0.12, 64) - Solid.sphere(0.118, 64)).translate(at)
    arc = ring(0.14, 0.005, 200.0).rotate((90, 0, 0)).rotate((0, 90 - tilt - 10, 0)).translate(at)
    way = (float(np.sin(np.radians(tilt))), 0.0, float(np.cos(np.radians(tilt))))
    pins = [
        rod(tuple(np.add(at, np.multiply(a, way))), tuple(np.add(at, np.multiply(b, way))), 0.004)
        for a, b in ((0.117, 0.142), (-0.142, -0.117))
    ]
    foot = turned([(0.0, 0.0), (0.09, 0.0), (0.09, 0.008), (0.03, 0.02), (0.01, 0.07), (0.0, 0.07)])
    return Form(body=(foot, arc), moving={"globe": spin([ball, *pins], at, way)})


def folding_chair() -> Form:
    """Two crossed frames of tube, a seat on the first, and a back."""
    frame = [rod((-0.2, y, 0.01), (0.2, y, 0.78), 0.011) for y in (-0.2, 0.2)]
    frame += [
        rod((0.1, -0.2, 0.59), (0.1, 0.2, 0.59), 0.01),
        rod((-0.19, -0.2, 0.03), (-0.19, 0.2, 0.03), 0.01),
    ]
    back = box((0.16, -0.19, 0.66), (0.175, 0.19, 0.77))
    legs = [rod((0.2, y, 0.01), (-0.05, y, 0.42), 0.011) for y in (-0.17, 0.17)]
    legs += [rod((0.18, -0.17, 0.04), (0.18, 0.17, 0.04), 0.01)]
    seat = rounded((0.34, 0.36, 0.012), 0.04).translate((-0.02, 0, 0.44))
    rails = [rod((0.02, y, 0.43), (0.02, y * 1.12, 0.43), 0.006) for y in (-0.17, 0.17)]
    return Form(
        body=(*frame, back),
        moving={
            "legs": hinge(legs, (0.005, 0, 0.405), (0, 1, 0), 0.4),
            "seat": hinge([seat, *rails], (0.02, 0, 0.43), (0, 1, 0), 0.9),
        },
    )


def laptop() -> Form:
    """A keyboard in a recess of a base, a lid that is open a hand's breadth, and 20 keys."""
    base = rounded((0.24, 0.34, 0.016), 0.012) - box((-0.02, -0.14, 0.01), (0.09, 0.14, 1.0))
    keys = {
        f"key_{row}{col}": slide([box((x, y, 0.0125), (x + 0.02, y + 0.048, 0.0175))], (0, 0, -1), 0.002)
        for row, x in enumerate((-0.016, 0.008, 0.032, 0.056))
        for col, y in enumerate(np.linspace(-0.136, 0.086, 5))
    }
    lid = rounded((0.24, 0.34, 0.006), 0.012).translate((-0.12, 0, 0)).rotate((0, 20, 0))
    barrel = rod((0, -0.1, 0), (0, 0.1, 0), 0.006)
    lid, barrel = (one.translate((0.118, 0, 0.022)) for one in (lid, barrel))
    return Form(body=(base,), moving={"lid": hinge([lid, barrel], (0.118, 0, 0.022), (0, 1, 0), 1.8), **keys})


def pliers() -> Form:
    """Two crossed levers with curved grips, each half as high about the pin that joins them."""

    def lever(side: float) -> list[Solid]:
        grip = [(0.014, 0.0085), (0.06, 0.02), (0.11, 0.022), (0.15, 0.012)]
        bars = [
            rod((x0, side * y0, 0.008), (x1, side * y1, 0.008), 0.007, 16)
            for (x0, y0), (x1, y1) in pairwise(grip)
        ]
        outline = [(-0.0095, -0.0004), (-0.06, -0.0004), (-0.06, -0.006), (-0.0095, -0.009)]
        jaw = manifold3d.CrossSection([np.array(outline)]).extrude(0.012).translate((0, 0, 0.002))
        low = 0.001 if side > 0 else 0.0082
        eye = Solid.cylinder(0.0068, 0.0085, 0.0085, 32).translate((0, 0, low))
        web = box((0.004, 0.002, low), (0.016, 0.01, low + 0.0068))
        web += box((-0.012, -0.008, low), (-0.004, -0.002, low + 0.0068))
        whole = [jaw, web] if side > 0 else [jaw.mirror((0, 1, 0)), web.mirror((0, 1, 0))]
        return [*bars, *whole, eye if side > 0 else eye - Solid.cylinder(0.03, 0.0045, 0.0045, 32)]

    pin = Solid.cylinder(0.018, 0.004, 0.004, 32)
    return Form(body=(*lever(1.0), pin), moving={"lever": hinge(lever(-1.0), (0, 0, 0.008), (0, 0, -1), 0.6)})


def usb_stick() -> Form:
    """A stick in a swivelling clip of sheet metal."""
    body = rounded((0.04, 0.018, 0.008), 0.006).translate((0, 0, 0.002))
    plug = hollow((-0.032, -0.006, 0.0035), (-0.018, 0.006, 0.0082), 0.0006, open_to=(-1, 0, 0))
    sheets = [rounded((0.055, 0.019, 0.001), 0.008).translate((-0.007, 0, z)) for z in (0.0, 0.0108)]
    end = box((-0.0345, -0.006, 0.0), (-0.0335, 0.006, 0.0118))
    pin = rod((0.012, 0, 0.0), (0.012, 0, 0.0118), 0.003)
    return Form(body=(body, plug), moving={"clip": spin([*sheets, end, pin], (0.012, 0, 0.006), (0, 0, 1))})


def pen() -> Form:
    """A turned barrel with a clip, and a button that is pressed."""
    profile = [(0.0, 0.0), (0.0008, 0.0), (0.004, 0.018), (0.006, 0.04), (0.0055, 0.12), (0.004, 0.13)]
    barrel = turned([*profile, (0.003, 0.13), (0.003, 0.1), (0.0, 0.1)])
    clip = box((-0.0085, -0.002, 0.085), (-0.0072, 0.002, 0.128)) + box(
        (-0.008, -0.002, 0.124), (-0.003, 0.002, 0.128)
    )
    button = turned([(0.0, 0.115), (0.0024, 0.115), (0.0024, 0.142), (0.0, 0.143)])
    lay = (0.0, 90.0, 0.0)
    lift = (-0.07, 0.0, 0.0063)
    laid = [one.rotate(lay).translate(lift) for one in (barrel, clip, button)]
    return Form(body=laid[:2], moving={"button": slide(laid[2:], (-1, 0, 0), 0.008)})


def suitcase() -> Form:
    """Two shells, a handle that pulls out of one, and four castors."""
    lower = rounded((0.36, 0.5, 0.12), 0.05) - rounded((0.354, 0.494, 0.13), 0.047).translate((0, 0, 0.003))
    upper = rounded((0.36, 0.5, 0.1), 0.05) - rounded((0.354, 0.494, 0.1), 0.047).translate((0, 0, -0.003))
    upper, lower = upper.translate((0, 0, 0.142)), lower.translate((0, 0, 0.02))
    grip = [rod((0.182, y, 0.05), (0.172, y, 0.05), 0.006) for y in (-0.06, 0.06)]
    bars = [rod((-0.1, y, 0.0145), (0.19, y, 0.0145), 0.005) for y in (-0.08, 0.08)]
    bars += [rod((0.19, -0.08, 0.0145), (0.19, 0.08, 0.0145), 0.007)]
    wheels = {
        f"wheel_{n}": spin(
            [rod((x, y - 0.01, 0.0105), (x, y + 0.01, 0.0105), 0.0105)], (x, y, 0.0105), (0, 1, 0)
        )
        for n, (x, y) in enumerate([(-0.14, -0.2), (-0.14, 0.2), (0.14, -0.2), (0.14, 0.2)])
    }
    return Form(
        body=(lower, *grip),
        moving={
            "lid": hinge([upper], (0.18, 0, 0.141), (0, 1, 0), 1.6),
            "handle": slide(bars, (1, 0, 0), 0.25),
            **wheels,
        },
    )


def lamp() -> Form:
    """A foot, two arms of bars and a shade that is a thin cone."""
    foot = turned([(0.0, 0.0), (0.1, 0.0), (0.095, 0.015), (0.012, 0.025), (0.012, 0.05), (0.0, 0.05)])
    low = [rod((0, y, 0.05), (0.12, y, 0.35), 0.005) for y in (-0.012, 0.012)]
    low += [
        rod((0, -0.016, 0.05), (0, 0.016, 0.05), 0.007),
        rod((0.12, -0.016, 0.35), (0.12, 0.016, 0.35), 0.007),
    ]
    high = [rod((0.12, y, 0.35), (-0.14, y, 0.5), 0.005) for y in (-0.006, 0.006)]
    shade = turned([(0.016, 0.07), (0.075, 0.0), (0.0765, 0.0), (0.0175, 0.071)])
    cap = turned([(0.0, 0.065), (0.017, 0.065), (0.017, 0.09), (0.0, 0.09)])
    head = [one.rotate((0, 20, 0)).translate((-0.17, 0, 0.42)) for one in (shade, cap)]
    return Form(
        body=(foot,),
        moving={
            "arm": hinge(low, (0, 0, 0.05), (0, 1, 0), 0.4),
            "forearm": hinge(high, (0.12, 0, 0.35), (0, 1, 0), 0.5, parent="arm"),
            "shade": hinge(head, (-0.14, 0, 0.5), (0, 1, 0), 0.6, parent="forearm"),
        },
    )


def cart() -> Form:
    """A basket of wires on a frame of tube with four wheels."""
    wires = [rod((x, -0.2, 0.5), (x, 0.2, 0.5), 0.003, 8) for x in np.linspace(-0.3, 0.3, 13)]
    wires += [
        rod((x, y, 0.5), (x * 1.1, y * 1.1, 0.75), 0.003, 8)
        for x in np.linspace(-0.3, 0.3, 7)
        for y in (-0.2, 0.2)
    ]
    wires += [
        rod((x, y, 0.5), (x * 1.1, y * 1.1, 0.75), 0.003, 8)
        for x in (-0.3, 0.3)
        for y in np.linspace(-0.2, 0.2, 5)
    ]
    rims = [(-0.33, -0.22), (0.33, -0.22), (0.33, 0.22), (-0.33, 0.22)]
    wires += [rod((*a, 0.75), (*b, 0.75), 0.006) for a, b in zip(rims, rims[1:] + rims[:1], strict=True)]
    wires += [
        rod((0.3 * a, 0.2 * b, 0.5), (0.3 * c, 0.2 * d, 0.5), 0.006)
        for a, b, c, d in ((-1, -1, 1, -1), (-1, 1, 1, 1))
    ]
    frame = [rod((x, y, 0.1), (x, y, 0.5), 0.011) for x in (-0.28, 0.28) for y in (-0.18, 0.18)]
    frame += [rod((-0.28, y, 0.12), (0.28, y, 0.12), 0.011) for y in (-0.18, 0.18)]
    bow = [rod((0.33, y, 0.75), (0.42, y, 0.95), 0.01) for y in (-0.2, 0.2)] + [
        rod((0.42, -0.21, 0.95), (0.42, 0.21, 0.95), 0.014)
    ]
    wheels = {
        f"wheel_{n}": spin([rod((x, y - 0.014, 0.05), (x, y + 0.014, 0.05), 0.05)], (x, y, 0.05), (0, 1, 0))
        for n, (x, y) in enumerate([(-0.28, -0.18), (-0.28, 0.18), (0.28, -0.18), (0.28, 0.18)])
    }
    return Form(body=(*wires, *frame, *bow), moving=wheels)


def faucet() -> Form:
    """A bent spout on a foot, and a lever above."""
    foot = turned([(0.0, 0.0), (0.028, 0.0), (0.022, 0.02), (0.02, 0.12), (0.0, 0.125)])
    pipe = manifold3d.CrossSection.circle(0.011, 32) - manifold3d.CrossSection.circle(0.008, 32)
    spout = pipe.translate((0.07, 0)).revolve(64, 150.0).rotate((90, 0, 0)).translate((-0.098, 0, 0.1))
    lever = [
        turned([(0.0, 0.127), (0.02, 0.127), (0.016, 0.15), (0.0, 0.155)]),
        rod((0.0, 0, 0.145), (0.08, 0, 0.17), 0.006),
    ]
    return Form(body=(foot, spout), moving={"lever": hinge(lever, (0, 0, 0.127), (0, 0, 1), 1.2)})


def remote() -> Form:
    """A slab with a hollow back, a battery cover that slides, and ten buttons."""
    slab = (
        rounded((0.18, 0.05, 0.02), 0.02)
        - box((0.0, -0.018, -0.1), (0.07, 0.018, 0.014))
        - box((-0.002, -0.021, -0.1), (1.0, 0.021, 0.0025))
    )
    cover = box((0.0, -0.02, 0.0002), (0.07, 0.02, 0.0022))
    keys = {
        f"button_{row}{col}": slide(
            [Solid.cylinder(0.006, 0.006, 0.005, 24).translate((x, y, 0.017))], (0, 0, -1), 0.0015
        )
        for row, x in enumerate(np.linspace(-0.07, 0.01, 5))
        for col, y in enumerate((-0.01, 0.01))
    }
    return Form(body=(slab,), moving={"cover": slide([cover], (1, 0, 0), 0.05), **keys})
