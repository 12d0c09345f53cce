"""Forms made after conversion was developed, measured as they are: nothing is developed by them."""

from itertools import pairwise

import manifold3d
import numpy as np
from form import Form, Solid, box, hinge, hollow, ring, rod, rounded, slide, spin, turned


def lunch_box() -> Form:
    """A rounded bowl with a lid that turns about its back, and a latch on each side of the front."""
    bowl = rounded((0.15, 0.21, 0.06), 0.03) - rounded((0.145, 0.205, 0.06), 0.0275).translate((0, 0, 0.003))
    lid = rounded((0.156, 0.216, 0.014), 0.033) - rounded((0.151, 0.211, 0.0115), 0.03).translate(
        (0, 0, -0.001)
    )
    lid = lid.translate((0, 0, 0.0605)) + rod((0.081, -0.05, 0.062), (0.081, 0.05, 0.062), 0.003)
    latches = {}
    for name, y in (("left", -0.06), ("right", 0.06)):
        clip = box((-0.083, y - 0.012, 0.038), (-0.0805, y + 0.012, 0.0725))
        clip += box((-0.083, y - 0.012, 0.0385), (-0.0755, y + 0.012, 0.0415))
        latches[f"latch_{name}"] = hinge(
            [clip, rod((-0.081, y - 0.014, 0.072), (-0.081, y + 0.014, 0.072), 0.0022)],
            (-0.081, y, 0.072), (0, 1, 0), 1.2, parent="lid",
        )  # fmt: skip
    return Form(body=(bowl,), moving={"lid": hinge([lid], (0.081, 0, 0.062), (0, 1, 0), 1.7), **latches})


def sewing_box() -> Form:
    """A wooden chest with a lid, two drawers one above the other with turned knobs, and a carrying bow."""
    case = box((-0.1, -0.15, 0.0), (0.1, 0.15, 0.2)) - box((-0.2, -0.143, 0.006), (0.093, 0.143, 0.062))
    case -= box((-0.2, -0.143, 0.068), (0.093, 0.143, 0.124))
    case -= box((-0.093, -0.143, 0.13), (0.093, 0.143, 0.3))
    feet = [turned([(0.0, -0.015), (0.008, -0.015), (0.012, 0.0), (0.0, 0.0)]).translate((x, y, 0.0))
            for x in (-0.08, 0.08) for y in (-0.13, 0.13)]  # fmt: skip
    knob = turned([(0.0, 0.0), (0.003, 0.0), (0.003, 0.006), (0.008, 0.01), (0.007, 0.015), (0.0, 0.017)])
    drawers = {}
    for n, z in enumerate((0.007, 0.069)):
        tray = hollow((-0.0985, -0.142, z), (0.09, 0.142, z + 0.053), 0.004, open_to=(0, 0, 1))
        knobs = [knob.rotate((0, -90, 0)).translate((-0.098, y, z + 0.027)) for y in (-0.07, 0.07)]
        drawers[f"drawer_{n}"] = slide([tray, *knobs], (-1, 0, 0), 0.15)
    lid = rounded((0.204, 0.304, 0.012), 0.004).translate((0, 0, 0.2005))
    bow = ring(0.05, 0.003, 180.0).rotate((90, 0, 90)).translate((0, 0, 0.216))
    ends = [rod((0, y, 0.21), (0, y, 0.22), 0.005) for y in (-0.05, 0.05)]
    return Form(
        body=(case, *feet),
        moving={
            "lid": hinge([lid, *ends], (0.102, 0, 0.2015), (0, 1, 0), 1.6),
            "handle": hinge([bow], (0, 0, 0.216), (0, 1, 0), 1.4, parent="lid"),
            **drawers,
        },
    )


def paper_cutter() -> Form:
    """A board with a fence, a long bent blade with a grip on a pin, and a ruler that slides."""
    board = [box((-0.16, -0.2, 0.008), (0.16, 0.2, 0.026)), box((-0.15, -0.2, 0.026), (-0.14, 0.19, 0.032))]
    board += [
        Solid.cylinder(0.008, 0.012, 0.01, 24).translate((x, y, 0))
        for x in (-0.13, 0.13)
        for y in (-0.17, 0.17)
    ]
    board += [box((0.161, -0.2, 0.01), (0.164, 0.19, 0.0265)), box((0.155, 0.19, 0.01), (0.185, 0.2, 0.05))]
    edge = [(0.19, 0.045), (0.1, 0.055), (0.0, 0.075), (-0.1, 0.105), (-0.19, 0.14)]
    outline = [*edge, *((y, z + 0.025) for y, z in reversed(edge))]
    blade = manifold3d.CrossSection([np.array(outline)[::-1]]).extrude(0.003)
    blade = blade.rotate((90, 0, 90)).translate((0.1655, 0, 0))
    grip = rod((0.167, -0.18, 0.149), (0.167, -0.27, 0.18), 0.011)
    pin = rod((0.16, 0.185, 0.058), (0.176, 0.185, 0.058), 0.005)
    bar = [
        box((-0.13, -0.16, 0.0265), (0.15, -0.145, 0.03)),
        rod((0.1, -0.1525, 0.03), (0.1, -0.1525, 0.042), 0.006),
    ]
    return Form(
        body=board,
        moving={
            "blade": hinge([blade, grip, pin], (0.168, 0.185, 0.058), (1, 0, 0), 0.35),
            "ruler": slide(bar, (0, 1, 0), 0.2),
        },
    )


def tap() -> Form:
    """Two cross handles beside a spout that swings, on one horizontal pipe against a wall."""
    body = [rod((0, -0.1, 0.05), (0, 0.1, 0.05), 0.014), rod((0, 0, 0.05), (0, 0, 0.085), 0.013)]
    for y in (-0.08, 0.08):
        body += [
            rod((0, y, 0.05), (0.07, y, 0.05), 0.011),
            rod((0.066, y, 0.05), (0.072, y, 0.05), 0.028, 48),
        ]
    way = [(0.0, 0.095), (-0.012, 0.14), (-0.05, 0.165), (-0.1, 0.155), (-0.118, 0.12)]
    spout = [rod((x0, 0, z0), (x1, 0, z1), 0.009) for (x0, z0), (x1, z1) in pairwise(way)]
    spout += [Solid.sphere(0.009, 24).translate((x, 0, z)) for x, z in way[1:-1]]
    spout += [rod((0, 0, 0.087), (0, 0, 0.1), 0.012), rod((-0.1176, 0, 0.121), (-0.121, 0, 0.113), 0.011)]
    handles = {}
    for name, y, sign in (("left", -0.104, -1.0), ("right", 0.104, 1.0)):
        arms = [rod((-0.03, y + 0.014 * sign, 0.05), (0.03, y + 0.014 * sign, 0.05), 0.005)]
        arms += [rod((0, y + 0.014 * sign, 0.02), (0, y + 0.014 * sign, 0.08), 0.005)]
        arms += [rod((0, y - 0.002 * sign, 0.05), (0, y + 0.022 * sign, 0.05), 0.01)]
        handles[f"handle_{name}"] = spin(arms, (0, y, 0.05), (0, 1, 0))
    return Form(body=body, moving={"spout": hinge(spout, (0, 0, 0.09), (0, 0, 1), 1.2), **handles})


def desk_stapler() -> Form:
    """A foot, a magazine of bent sheet with a pusher that slides in it, and a bowed arm above."""
    foot = rounded((0.15, 0.036, 0.006), 0.017) + box((0.045, -0.015, 0.0), (0.07, 0.015, 0.014))
    ears = [box((0.05, y, 0.01), (0.07, y + 0.0015, 0.034)) for y in (-0.0165, 0.015)]
    channel = box((-0.07, -0.008, 0.0145), (0.062, 0.008, 0.027)) - box(
        (-0.068, -0.0068, 0.016), (0.1, 0.0068, 0.1)
    )
    arc = [(x, 0.03 + 0.018 * float(np.cos(np.pi * x / 0.15))) for x in np.linspace(-0.074, 0.068, 12)]
    outline = [(-0.074, 0.029), (0.068, 0.029), *reversed(arc)]
    arm = (
        manifold3d.CrossSection([np.array(outline)])
        .extrude(0.026)
        .rotate((90, 0, 0))
        .translate((0, 0.013, 0))
    )
    arm -= box((-0.07, -0.0115, 0.0), (0.1, 0.0115, 0.035))
    pusher = [box((0.0, -0.0055, 0.0175), (0.012, 0.0055, 0.026))]
    return Form(
        body=(foot, *ears),
        moving={
            "magazine": hinge([channel], (0.06, 0, 0.022), (0, 1, 0), 0.2),
            "arm": hinge([arm], (0.06, 0, 0.033), (0, 1, 0), 0.8),
            "pusher": slide(pusher, (-1, 0, 0), 0.05, parent="magazine"),
        },
    )


def stepladder() -> Form:
    """Two frames of square tube that open about a line on top, treads on the first, and a platform."""

    def frame(x: float, wide: float) -> list[Solid]:
        bar = manifold3d.CrossSection.square((0.024, 0.02), center=True).extrude(0.78)
        tilt = float(np.degrees(np.arctan2(x, 0.76)))
        return [bar.rotate((0, tilt + 180, 0)).translate((0, y, 0.78)) for y in (-wide, wide)]

    front, rear = frame(0.28, 0.2), frame(-0.22, 0.17)
    treads = [
        box((x - 0.04, -0.19, z), (x + 0.035, 0.19, z + 0.02))
        for x, z in ((-0.214, 0.2), (-0.14, 0.4), (-0.066, 0.6))
    ]
    cross = [
        rod((0.22 * (0.78 - z) / 0.76, -0.17, z), (0.22 * (0.78 - z) / 0.76, 0.17, z), 0.008)
        for z in (0.15, 0.45)
    ]
    top = rounded((0.16, 0.44, 0.025), 0.03).translate((-0.02, 0, 0.785))
    return Form(
        body=(*front, *treads, top),
        moving={"rear": hinge([*rear, *cross], (0, 0, 0.775), (0, 1, 0), 0.45)},
    )


def punch() -> Form:
    """A foot with two dies, a bent lever on a pin between cheeks, and a tray below that slides out."""
    foot = box((-0.05, -0.055, 0.004), (0.05, 0.055, 0.02)) - box((-0.1, -0.05, 0.002), (0.045, 0.05, 0.015))
    cheeks = [box((0.0, y, 0.02), (0.045, y + 0.004, 0.055)) for y in (-0.05, 0.046)]
    dies = [Solid.cylinder(0.02, 0.006, 0.006, 24).translate((-0.015, y, 0.019)) for y in (-0.04, 0.04)]
    sheet = [(0.045, 0.06), (0.02, 0.068), (-0.02, 0.078), (-0.075, 0.082)]
    outline = [*sheet, *((x, z - 0.003) for x, z in reversed(sheet))]
    lever = (
        manifold3d.CrossSection([np.array(outline)])
        .extrude(0.084)
        .rotate((90, 0, 0))
        .translate((0, 0.042, 0))
    )
    pin = rod((0.03, -0.0455, 0.05), (0.03, 0.0455, 0.05), 0.0035)
    web = [box((0.025, y - 0.002, 0.048), (0.036, y + 0.002, 0.064)) for y in (-0.03, 0.03)]
    tray = hollow((-0.0495, -0.049, 0.0), (0.044, 0.049, 0.014), 0.0015, open_to=(0, 0, 1))
    return Form(
        body=(foot, *cheeks, *dies),
        moving={
            "lever": hinge([lever, pin, *web], (0.03, 0, 0.05), (0, -1, 0), 0.3),
            "tray": slide([tray], (-1, 0, 0), 0.05),
        },
    )


def mailbox() -> Form:
    """A vaulted box on a post, with a door that falls forwards and a flag that is raised."""
    outline = rounded((0.2, 0.4, 0.17), 0.0001) + rod((0, -0.2, 0.17), (0, 0.2, 0.17), 0.1, 48)
    inside = rounded((0.19, 0.42, 0.165), 0.0001).translate((0, 0, 0.005)) + rod(
        (0, -0.3, 0.17), (0, 0.3, 0.17), 0.095, 48
    )
    case = (outline - inside) + (outline ^ box((-1, 0.195, 0), (1, 0.2, 1)))
    turn = (0, 0, -90)
    post = [box((-0.04, -0.04, 0.0), (0.04, 0.04, 1.0)), box((-0.2, -0.2, 0.0), (0.2, 0.2, 0.02))]
    front = (outline ^ box((-1, -0.2, 0), (1, -0.196, 1))).translate((0, -0.006, 0))
    grip = rod((0.0, -0.225, 0.2), (0.0, -0.2, 0.2), 0.008)
    flag = [box((-0.05, 0.104, 1.1), (0.05, 0.107, 1.115)), box((0.02, 0.104, 1.1), (0.06, 0.107, 1.16))]
    return Form(
        body=(*post, case.rotate(turn).translate((0, 0, 1.0))),
        moving={
            "door": hinge(
                [one.rotate(turn).translate((0, 0, 1.0)) for one in (front, grip)],
                (-0.204, 0, 1.003), (0, -1, 0), 1.5,
            ),
            "flag": hinge(flag, (-0.04, 0.105, 1.107), (0, 1, 0), 1.5),
        },
    )  # fmt: skip


def waffle_iron() -> Form:
    """Two round halves with ribbed plates, a hinge behind and a handle in front."""
    shell = turned([(0.0, 0.0), (0.1, 0.0), (0.115, 0.02), (0.115, 0.04), (0.0, 0.04)])
    ribs = [box((-0.08, -0.003 + y, 0.04), (0.08, 0.003 + y, 0.046)) for y in np.linspace(-0.06, 0.06, 5)]
    upper = shell.rotate((180, 0, 0)).translate((0, 0, 0.092))
    handles = [box((-0.21, -0.015, z), (-0.105, 0.015, z + 0.015)) for z in (0.02, 0.058)]
    feet = [rod((0.08 * c, 0.08 * s, -0.01), (0.08 * c, 0.08 * s, 0.005), 0.01) for c, s in
            ((0.8, 0.6), (-0.8, 0.6), (0.8, -0.6), (-0.8, -0.6))]  # fmt: skip
    block = box((0.11, -0.03, 0.01), (0.13, 0.03, 0.045))
    arm = box((0.11, -0.025, 0.05), (0.13, 0.025, 0.075))
    return Form(
        body=(shell, *ribs, handles[0], block, *feet),
        moving={"lid": hinge([upper, handles[1], arm], (0.13, 0, 0.048), (0, 1, 0), 1.7)},
    )


def padlock() -> Form:
    """A case that lies flat, a shackle of bent wire that slides out, and a disc over the keyhole."""
    bores = [rod((-0.03, y, 0.01), (0.0, y, 0.01), 0.0045) for y in (-0.014, 0.014)]
    case = box((-0.02, -0.025, 0.0), (0.025, 0.025, 0.02)) - bores[0] - bores[1]
    bow = ring(0.014, 0.004, 180.0).rotate((0, 0, 90)).translate((-0.03, 0, 0.01))
    legs = [rod((-0.03, y, 0.01), (-0.002, y, 0.01), 0.004) for y in (-0.014, 0.014)]
    disc = rod((0.0255, 0, 0.01), (0.027, 0, 0.01), 0.006)
    return Form(
        body=(case,),
        moving={
            "shackle": slide([bow, *legs], (-1, 0, 0), 0.012),
            "cover": hinge([disc], (0.026, 0.004, 0.01), (1, 0, 0), 1.5),
        },
    )


def bench_vise() -> Form:
    """A foot with a fixed jaw, a jaw that slides on a bar, and a spindle with a crank that turns."""
    foot = [box((-0.1, -0.06, 0.0), (0.1, 0.06, 0.015)), box((0.02, -0.05, 0.015), (0.08, 0.05, 0.1))]
    foot += [box((0.02, -0.05, 0.1), (0.04, 0.05, 0.14))]
    body = foot[0] + foot[1] + foot[2] - box((-1, -0.021, 0.039), (1, 0.021, 0.081))
    jaw = [box((-0.02, -0.05, 0.05), (0.015, 0.05, 0.14)), box((-0.02, -0.019, 0.041), (0.09, 0.019, 0.079))]
    crank = [
        rod((-0.06, 0, 0.06), (-0.0205, 0, 0.06), 0.009),
        rod((-0.05, -0.07, 0.06), (-0.05, 0.07, 0.06), 0.005),
    ]
    crank += [Solid.sphere(0.009, 24).translate((-0.05, y, 0.06)) for y in (-0.07, 0.07)]
    return Form(
        body=(body,),
        moving={
            "jaw": slide(jaw, (-1, 0, 0), 0.05),
            "crank": spin(crank, (-0.05, 0, 0.06), (1, 0, 0), parent="jaw"),
        },
    )


def easel() -> Form:
    """Two legs with a shelf, a third one that swings back, and a mast that slides up."""
    legs = [rod((0.0, y, 0.0), (0.1, 0.3 * y, 1.5), 0.014) for y in (-0.35, 0.35)]
    bars = [box((-0.06, -0.3, 0.5), (0.05, 0.3, 0.52)), box((0.08, -0.12, 1.4), (0.11, 0.12, 1.44))]
    third = [rod((0.127, 0, 1.42), (0.6, 0, 0.0), 0.014)]
    mast = [box((0.055, -0.02, 0.55), (0.075, 0.02, 1.7)), box((0.03, -0.05, 1.66), (0.075, 0.05, 1.7))]
    return Form(
        body=(*legs, *bars),
        moving={
            "leg": hinge(third, (0.127, 0, 1.42), (0, 1, 0), 0.2),
            "mast": slide(mast, (0, 0, 1), 0.3),
        },
    )
