"""Objects of kinds that are not at hand, generated analytically, with the flaws of meshes in the wild.

python benchmarks/unseen_forms.py out/forms    # one folder with a URDF and its meshes per object

Links consist of separate solids that overlap, as those of PartNet-Mobility do.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import forms_developed as developed
import forms_fresh as fresh
import forms_held_out as held_out
import numpy as np
import tyro
from form import Flaw, Form, write_form


def doubled(triangles: np.ndarray) -> np.ndarray:
    """Every face from both sides."""
    return np.concatenate([triangles, triangles[:, ::-1]])


def repeated(triangles: np.ndarray) -> np.ndarray:
    """A third of all faces twice."""
    return np.concatenate([triangles, triangles[::3]])


def opened(triangles: np.ndarray) -> np.ndarray:
    """Without faces that look down, as nobody sees them."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[normals[:, 2] > -0.99 * np.linalg.norm(normals, axis=1)]


def sunk(depth: float) -> Flaw:
    """All that moves is so much (m) larger, and reaches into its neighbours."""

    def grow(triangles: np.ndarray) -> np.ndarray:
        low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
        size = np.maximum(high - low, 1e-9)
        return (triangles - (low + high) / 2) * (1.0 + 2.0 * depth / size) + (low + high) / 2

    return grow


DEVELOPED: Mapping[str, tuple[Callable[[], Form], Sequence[Flaw], float]] = {
    "coffee_machine": (developed.coffee_machine, (), 1.0),
    "globe": (developed.globe, (doubled,), 1.0),
    "folding_chair": (developed.folding_chair, (repeated,), 1.05),
    "laptop": (developed.laptop, (opened,), 1.0),
    "pliers": (developed.pliers, (), 1.0),
    "usb_stick": (developed.usb_stick, (doubled,), 1.0),
    "pen": (developed.pen, (sunk(0.0005),), 1.0),
    "suitcase": (developed.suitcase, (sunk(0.001),), 1.0),
    "lamp": (developed.lamp, (repeated,), 1.0),
    "cart": (developed.cart, (), 1.0),
    "faucet": (developed.faucet, (opened,), 1.05),
    "remote": (developed.remote, (doubled,), 1.0),
}
"""Forms by name, with the flaws of their meshes, and what their ranges are multiplied by."""
HELD_OUT: Mapping[str, tuple[Callable[[], Form], Sequence[Flaw], float]] = {
    "camera": (held_out.camera, (), 1.0),
    "fan": (held_out.fan, (repeated,), 1.0),
    "phone": (held_out.phone, (opened,), 1.0),
    "keyboard": (held_out.keyboard, (), 1.0),
    "syringe": (held_out.syringe, (), 1.0),
    "eyeglasses": (held_out.eyeglasses, (), 1.05),
    "printer": (held_out.printer, (sunk(0.002),), 1.0),
    "safe": (held_out.safe, (sunk(0.001),), 1.0),
    "door": (held_out.door, (doubled,), 1.05),
    "window": (held_out.window, (opened,), 1.0),
    "lighter": (held_out.lighter, (doubled,), 1.0),
}
FRESH: Mapping[str, tuple[Callable[[], Form], Sequence[Flaw], float]] = {
    "lunch_box": (fresh.lunch_box, (sunk(0.0005),), 1.0),
    "sewing_box": (fresh.sewing_box, (doubled,), 1.0),
    "paper_cutter": (fresh.paper_cutter, (), 1.0),
    "tap": (fresh.tap, (opened,), 1.0),
    "desk_stapler": (fresh.desk_stapler, (repeated,), 1.0),
    "stepladder": (fresh.stepladder, (), 1.05),
    "punch": (fresh.punch, (doubled,), 1.0),
    "mailbox": (fresh.mailbox, (doubled,), 1.0),
    "waffle_iron": (fresh.waffle_iron, (repeated,), 1.05),
    "padlock": (fresh.padlock, (), 1.0),
    "bench_vise": (fresh.bench_vise, (sunk(0.0005),), 1.0),
    "easel": (fresh.easel, (opened,), 1.0),
}


def main(out: tyro.conf.Positional[Path]) -> None:
    """Writes all objects."""
    for name, (make, flaws, reach) in {**DEVELOPED, **HELD_OUT, **FRESH}.items():
        print(write_form(make(), out / name, name, flaws, reach))


if __name__ == "__main__":
    tyro.cli(main)
