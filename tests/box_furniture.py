"""Furniture of plain boxes with doors or drawers, as packages whose report says that they passed."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from artigen.types import Joint
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull
from sim_export.package import Inertial, Link, Mesh, SimPackage, Visual
from sim_export.report import CheckResult, Report, write_report

WALL = 0.018


@dataclass(frozen=True, kw_only=True)
class Furniture:
    """A box with fronts: ``doors`` side by side (hinged left, right, left ...) or ``drawers`` in a stack."""

    name: str
    category: str
    size: tuple[float, float, float]
    doors: int = 0
    drawers: int = 0
    swing: float = 1.6


FURNITURE = (
    Furniture(name="base_a", category="StorageFurniture", size=(0.6, 0.6, 0.88), doors=2),
    Furniture(name="base_b", category="StorageFurniture", size=(0.6, 0.8, 0.88), drawers=3),
    Furniture(name="fridge", category="Refrigerator", size=(0.66, 0.7, 1.8), doors=1, swing=2.2),
    Furniture(name="range", category="Oven", size=(0.62, 0.6, 0.9), drawers=1),
    Furniture(name="hung", category="StorageFurniture", size=(0.33, 0.6, 0.7), doors=2),
    Furniture(name="microwave", category="Microwave", size=(0.38, 0.5, 0.3), doors=1),
    Furniture(name="desk", category="Table", size=(0.7, 1.3, 0.74), drawers=1),
    Furniture(name="pedestal", category="StorageFurniture", size=(0.5, 0.42, 0.6), drawers=2),
    Furniture(name="bookcase", category="StorageFurniture", size=(0.4, 0.9, 1.9), doors=2),
    Furniture(name="wardrobe", category="StorageFurniture", size=(0.6, 1.2, 2.1), doors=2),
    Furniture(name="dresser", category="StorageFurniture", size=(0.48, 1.0, 0.9), drawers=3),
    Furniture(name="nightstand", category="StorageFurniture", size=(0.4, 0.45, 0.52), drawers=1),
    Furniture(name="lowboard", category="StorageFurniture", size=(0.42, 1.5, 0.48), doors=2),
    Furniture(name="low table", category="Table", size=(0.6, 1.0, 0.42), drawers=1),
    Furniture(name="toilet", category="Toilet", size=(0.62, 0.38, 0.8)),
    Furniture(name="washer", category="WashingMachine", size=(0.6, 0.6, 0.88), doors=1),
    Furniture(name="files", category="FilingCabinet", size=(0.6, 0.45, 1.3), drawers=4),
    Furniture(name="bin", category="TrashCan", size=(0.3, 0.3, 0.5)),
    Furniture(name="window", category="Window", size=(0.08, 0.9, 1.1), doors=1, swing=1.4),
    Furniture(name="door", category="Door", size=(0.2, 0.9, 2.1), doors=1, swing=1.6),
    Furniture(name="laptop", category="Laptop", size=(0.25, 0.36, 0.03)),
    Furniture(name="sideboard", category="StorageFurniture", size=(0.42, 1.4, 0.78), doors=2),
)


def solid_link(name: str, label, boxes) -> Link:
    """A link of boxes with a plausible mass."""
    hulls = tuple(box_hull(np.array(low), np.array(high)) for low, high in boxes)
    meshes = [Mesh(vertices=hull.vertices, faces=hull.faces) for hull in hulls]
    visuals = tuple(
        Visual(name=f"{label}_{name}_{index}", part=name, label=label, mesh=mesh)
        for index, mesh in enumerate(meshes)
    )
    center = np.mean([hull.vertices.mean(axis=0) for hull in hulls], axis=0)
    inertial = Inertial(mass=5.0, com=center, inertia=np.eye(3) * 0.2)
    return Link(name=name, label=label, parts=(name,), visuals=visuals, hulls=hulls, inertial=inertial)


def build_furniture(kind: Furniture) -> SimPackage:
    """The piece as a package, centred, front at -x."""
    depth, width, height = kind.size
    x0, x1, y0, y1, z = -depth / 2 + 0.02, depth / 2, -width / 2, width / 2, height / 2
    body = [
        ((x1 - WALL, y0, -z), (x1, y1, z)),
        ((x0, y0, -z), (x1 - WALL, y0 + WALL, z)),
        ((x0, y1 - WALL, -z), (x1 - WALL, y1, z)),
        ((x0, y0, z - WALL), (x1, y1, z)),
        ((x0, y0 + WALL, -z), (x1 - WALL, y1 - WALL, -z + WALL)),
    ]
    links, joints = [], []
    for index in range(kind.doors):
        left, right = y0 + index * width / kind.doors + 0.003, y0 + (index + 1) * width / kind.doors - 0.003
        panel = ((x0 - 0.02, left, -z + 0.003), (x0 - 0.002, right, z - 0.003))
        low = index % 2 == 0
        links.append(solid_link(f"link_{index}", "door", [panel]))
        joints.append(
            Joint(
                name=f"joint_{index}", type="revolute", parent="body", child=f"link_{index}",
                origin=np.array([x0 - 0.02, left if low else right, 0.0]),
                axis=np.array([0.0, 0.0, 1.0 if low else -1.0]), lower=0.0, upper=kind.swing, friction=0.5,
                damping=0.5,
            )
        )  # fmt: skip
    for index in range(kind.drawers):
        low, high = -z + 2 * z * index / kind.drawers + 0.02, -z + 2 * z * (index + 1) / kind.drawers - 0.02
        front = ((x0 - 0.02, y0 + 0.003, low), (x0 - 0.002, y1 - 0.003, high))
        tray = ((x0 - 0.002, y0 + 0.04, low), (x1 - 0.05, y1 - 0.04, low + 0.02))
        links.append(solid_link(f"link_{index}", "drawer", [front, tray]))
        joints.append(
            Joint(
                name=f"joint_{index}", type="prismatic", parent="body",
                child=f"link_{index}", origin=np.zeros(3), axis=np.array([-1.0, 0.0, 0.0]), lower=0.0,
                upper=0.3, friction=3.0, damping=5.0,
            )
        )  # fmt: skip
    base = Link(name="base", label=None, parts=(), visuals=(), hulls=(), inertial=None)
    fixed = Joint(
        name=f"joint_{len(links)}", type="fixed", parent="base", child="body",
        origin=np.zeros(3), axis=np.array([1.0, 0.0, 0.0]),
    )  # fmt: skip
    return SimPackage(
        name=kind.name,
        category=kind.category,
        visual="voxels",
        links=(base, *links, solid_link("body", "base", body)),
        joints=(*joints, fixed),
        provenance=(("source", f"a box called {kind.name}"),),
    )


def write_proven(kind: Furniture, folder: Path, verdict: str = "pass") -> Path:
    """The package with a report that says it passed, or not."""
    path = write_package(build_furniture(kind), folder / kind.name)
    check = CheckResult(id="V203", level="L2", title="sweep", verdict=verdict)  # pyright: ignore
    write_report(Report(package=kind.name, checks=(check,)), path / "validation.json")
    return path
