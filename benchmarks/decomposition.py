"""Compares convex decompositions of the same parts: ours, CoACD and V-HACD.

    python benchmarks/decomposition.py                       # the sample cabinet and turned shapes
    python benchmarks/decomposition.py OBJECTS 7304 46490    # parts of PartNet-Mobility objects as well

``OBJECTS`` is a folder of PartNet-Mobility objects. Volume error is the symmetric difference of hulls
and mesh over the mesh's volume. CoACD and V-HACD run with their default parameters and 32 hulls at most, in
processes of their own whose start is taken off their time.
Prints a markdown table.
"""

import logging
import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import manifold3d
import tyro
from sample_cabinet import sample_asset

from artigen.datasets.partnet_mobility import read_object
from artigen.types import Asset
from artigen.voxels.voxelize import voxelize
from sim_export.collision.cover.object_cover import ObjectCover
from sim_export.collision.tools import DecompositionFailed, decompose
from sim_export.geometry.boards import fill_boards
from sim_export.geometry.meshing import mesh_parts
from sim_export.geometry.solids import as_solid, solid_arrays
from sim_export.package import Hull, Mesh

Solid = manifold3d.Manifold
METHODS = ("auto", "CoACD", "V-HACD")
MOST = 32
"""Hulls of a part, at most."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One part by one method; ``hulls`` 0 where it failed or ran out of time."""

    seconds: float
    hulls: int
    error: float


def turned_shapes() -> dict[str, Mesh]:
    """Round and slanted parts that no box fits."""
    pot = Solid.cylinder(0.3, 0.2, 0.2, 48) - Solid.cylinder(0.3, 0.185, 0.185, 48).translate((0, 0, 0.015))
    drum = Solid.cylinder(0.4, 0.25, 0.25, 64) - Solid.cylinder(0.38, 0.24, 0.24, 64).translate((0, 0, 0.01))
    legs = [
        Solid.cylinder(0.5, 0.02, 0.03, 24).rotate((8 * x, 8 * y, 0)).translate((0.3 * x, 0.4 * y, 0))
        for x in (-1, 1)
        for y in (-1, 1)
    ]
    top = Solid.cylinder(0.03, 0.6, 0.6, 64).translate((0, 0, 0.48))
    table = Solid.batch_boolean([*legs, top], manifold3d.OpType.Add)
    solids = {"pot": pot, "drum": drum, "round table": table}
    arrays = {name: solid_arrays(solid) for name, solid in solids.items()}
    return {name: Mesh(vertices=vertices, faces=faces) for name, (vertices, faces) in arrays.items()}


def hollow_parts(asset: Asset, most: int) -> Iterator[tuple[str, Mesh]]:
    """The parts of an object that one hull does not stand for, those with most faces first."""
    assert asset.surface is not None
    voxels, _ = fill_boards(voxelize(asset.surface))
    asset = replace(asset, voxels=voxels)
    named = sorted(zip(asset.parts, mesh_parts(asset), strict=True), key=lambda pair: -len(pair[1].faces))
    hollow = [(part.name, mesh) for part, mesh in named if _excess(mesh) > 0.1]
    yield from ((f"{asset.name} {name}", mesh) for name, mesh in hollow[:most])


def _excess(mesh: Mesh) -> float:
    solid = as_solid(mesh)
    return solid.hull().volume() / solid.volume() - 1.0


def try_method(method: str, mesh: Mesh, timeout: float, start_up: float) -> Trial:
    """Time, hulls and volume error of one method on one part."""
    begin = time.perf_counter()
    try:
        hulls = _decompose(method, mesh, timeout)
    except DecompositionFailed as err:
        logging.getLogger(__name__).warning("%s: %s", method, err)
        return Trial(seconds=time.perf_counter() - begin, hulls=0, error=float("nan"))
    seconds = time.perf_counter() - begin - (start_up if method != "auto" else 0.0)
    solid, union = as_solid(mesh), Solid.batch_boolean(list(map(as_solid, hulls)), manifold3d.OpType.Add)
    error = ((union - solid).volume() + (solid - union).volume()) / solid.volume()
    return Trial(seconds=max(seconds, 0.01), hulls=len(hulls), error=error)


def _decompose(method: str, mesh: Mesh, timeout: float) -> tuple[Hull, ...]:
    triangles = mesh.vertices[mesh.faces]
    if method == "auto":
        return ObjectCover({"part": triangles}, {}, solid=True).make_hulls()["part"]
    if method == "CoACD":
        options = {"max_convex_hull": MOST, "decimate": True, "max_ch_vertex": 64}
        return decompose("coacd", triangles, options, timeout, "part")
    return decompose("vhacd", triangles, {"maxConvexHulls": MOST}, timeout, "part")


def main(
    objects: tyro.conf.Positional[Path | None] = None,
    ids: tyro.conf.Positional[tuple[str, ...]] = (),
    parts_per_object: int = 2,
    timeout: float = 120.0,
) -> None:
    """Decomposes every part by every method and prints a table."""
    parts = dict(hollow_parts(sample_asset(), 4)) | turned_shapes()
    for name in ids:
        assert objects is not None
        parts |= dict(hollow_parts(read_object(objects / name).asset, parts_per_object))
    corners, faces = solid_arrays(Solid.cube((1.0, 1.0, 1.0)))
    start_up = try_method("CoACD", Mesh(vertices=corners, faces=faces), timeout, 0.0).seconds
    rows: list[tuple[Trial, ...]] = []
    print(
        f"CoACD's process takes {start_up:.1f} s to start; a dash is a failure or more than {timeout:g} s.\n"
    )
    print("| part | faces | " + " | ".join(f"{m}: s, hulls, error" for m in METHODS) + " |")
    print("|---" * (2 + len(METHODS)) + "|")
    for name, mesh in parts.items():
        trials = tuple(try_method(method, mesh, timeout, start_up) for method in METHODS)
        rows.append(trials)
        cells = [
            f"{t.seconds:.2f}, {t.hulls}, {t.error:.3f}" if t.hulls else f"{t.seconds:.0f}, -" for t in trials
        ]
        print(f"| {name} | {len(mesh.faces)} | " + " | ".join(cells) + " |", flush=True)
    print(summarise(rows))


def summarise(rows: list[tuple[Trial, ...]]) -> str:
    """Medians and sums over the parts, over all of them and where every method gave hulls."""
    done = [row for row in rows if all(trial.hulls for trial in row)]
    lines = []
    for column, method in enumerate(METHODS):
        mine = [row[column] for row in rows]
        common = [row[column] for row in done]
        ratio = statistics.median(row[column].seconds / row[0].seconds for row in rows)
        lines.append(
            f"- {method}: {sum(t.seconds for t in mine):.1f} s, {ratio:.1f} times `auto` in the median; "
            f"{sum(t.hulls == 0 for t in mine)} of {len(mine)} parts failed; on the other {len(common)}: "
            f"volume error mean {statistics.fmean(t.error for t in common):.3f}, "
            f"median {statistics.median(t.error for t in common):.3f}, "
            f"hulls mean {statistics.fmean(t.hulls for t in common):.1f}"
        )
    smaller = sum(row[0].error < row[1].error for row in done)
    lines.append(f"- `auto` has the smaller volume error than CoACD on {smaller} of {len(done)} parts")
    return "\n" + "\n".join(lines)


if __name__ == "__main__":
    tyro.cli(main)
