"""Compares baked textures with their Gaussians: PSNR from the same cameras, closed and open.

    python benchmarks/texture_bake.py --objects Oven_2 Table_4 --out out/bake

Gaussians are discs on the surface of procedural objects (`artigen.splats.surface`). They are baked onto two
kinds of meshes: the objects' own surfaces (what the bake alone loses), and the meshes that the export makes
of 64^3 voxels (what a package loses; silhouettes differ too). A third row is of what
`--structure latent` draws within the boxes and in the paint of the object, its Gaussians on its meshes. All
are drawn without light, colours as they are. Writes a Markdown table, and a picture per object.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import tyro
from PIL import Image

from artigen.appearance.draw import generate_appearance, load_appearance_model
from artigen.appearance.paint import paint_surface, repaint
from artigen.camera import Camera, pixel_rays
from artigen.kinematics import articulate_gaussians, displacements, qlimits
from artigen.latent.draw import generate_structure, load_structure_model
from artigen.models.conditions import describe_shape
from artigen.shapes.asset import frame_shape, shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.splats.colors import srgb_from_linear
from artigen.splats.motion import scale_gaussians
from artigen.splats.parts import select_gaussians
from artigen.splats.render import RasterConfig
from artigen.splats.render.picture import draw_gaussians
from artigen.splats.surface import splat_surface
from artigen.types import Asset
from artigen.weights import SHIPPED
from sim_export.appearance.texture import BakedMesh, bake_mesh
from sim_export.geometry.meshing import mesh_parts
from sim_export.geometry.surface import sample_surface
from sim_export.package import Mesh
from sim_export.picture.raycast import Surface, albedo_at, build_scene, cast_layers
from sim_export.picture.render import move_surface, surface_from_mesh
from sim_export.picture.viewpoint import Viewpoint, place_camera
from sim_export.reference import build_reference

OBJECTS = ("StorageFurniture_3", "Oven_2", "Refrigerator_1", "Table_4", "Microwave_5", "Dishwasher_6")
VIEWS = (Viewpoint(width=320, height=320), Viewpoint(azimuth=-20.0, elevation=48.0, width=320, height=320))
SPACING = 1 / 160
"""Distance between discs over the longest edge."""
FACTOR = 3
"""Rays per edge of a pixel."""
BLACK = 8 / 255
"""What is darker than this in a mesh, and twice as bright in the Gaussians, is black where it must not be."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """What was measured of one object on one kind of mesh."""

    name: str
    meshes: str
    covered: float
    """Share of the texels that Gaussians of the own part cover."""
    psnr: float
    """dB over whole pictures, all views."""
    inner: float
    """dB over the pixels that mesh and Gaussians fill."""
    worst: float
    """dB of the worst picture."""
    black: float
    """Share of the object's pixels that are black and should not be."""
    seconds: float
    """Of the bake, processor time."""


def bake_all(asset: Asset, meshes: Sequence[Mesh]) -> list[BakedMesh]:
    """Every part's mesh in the colours of its Gaussians."""
    assert asset.gaussians is not None
    metres = scale_gaussians(asset.gaussians, asset.scale)
    return [
        bake_mesh(
            mesh,
            select_gaussians(metres, np.flatnonzero(metres.part_ids == index)),
            voxel=asset.scale / 64,
        )
        for index, mesh in enumerate(meshes)
    ]


def draw_meshes(surfaces: Sequence[Surface], camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Colours without light (sRGB in [0, 1], white behind) and the share of each pixel that is filled."""
    big = replace(
        camera, pixel=camera.pixel / FACTOR, width=FACTOR * camera.width, height=FACTOR * camera.height
    )
    scene, rays = build_scene(surfaces), pixel_rays(big).reshape(-1, 3)
    image, left = np.zeros((len(rays), 4)), np.ones(len(rays))
    for hits, cover in cast_layers(scene, big.position, rays):
        shown = srgb_from_linear(albedo_at(scene, hits))
        image[hits.place, :3] += (left[hits.place] * cover)[:, None] * shown
        image[hits.place, 3] = 1.0
        left[hits.place] *= 1.0 - cover
    image[:, :3] += left[:, None]
    small = image.reshape(camera.height, FACTOR, camera.width, FACTOR, 4).mean(axis=(1, 3))
    return small[..., :3], small[..., 3]


def measure(
    asset: Asset, kind: str, meshes: Sequence[Mesh], splats: dict[tuple[int, int], np.ndarray], out: Path
) -> Row:
    """Bakes one object and compares all pictures; ``splats`` is filled on the way and used again."""
    gaussians = asset.gaussians
    assert gaussians is not None
    started = time.process_time()
    baked = bake_all(asset, meshes)
    seconds = time.process_time() - started
    errors, inside, black, pictures = [], [], [], []
    for state, fraction in enumerate((0.0, 1.0)):
        qpos = fraction * qlimits(asset)[:, 1]
        T = displacements(asset, qpos)
        T[:, :3, 3] *= asset.scale
        surfaces = [move_surface(surface_from_mesh(one.mesh), T[k]) for k, one in enumerate(baked)]
        moved = scale_gaussians(articulate_gaussians(asset, qpos, gaussians), asset.scale)
        for number, view in enumerate(VIEWS):
            camera = place_camera(moved.means.astype(np.float64), view)
            if (state, number) not in splats:
                splats[state, number] = draw_gaussians(moved, camera, cfg=RasterConfig())
            wanted = splats[state, number] / 255.0
            got, filled = draw_meshes(surfaces, camera)
            error = ((got - wanted) ** 2).mean(axis=2)
            both = (filled > 0.99) & (wanted.min(axis=2) < 0.999)
            errors.append(error.mean())
            inside.append(error[both])
            black.append((got[both].max(axis=1) < BLACK) & (wanted[both].max(axis=1) > 2 * BLACK))
            pictures.append(np.concatenate([wanted, got], axis=0))
    image = np.rint(255 * np.concatenate(pictures, axis=1)).astype(np.uint8)
    Image.fromarray(image).save(out / f"{asset.name}_{kind}.png")
    texels = sum(one.texels for one in baked)
    return Row(
        name=asset.name,
        meshes=kind,
        covered=sum(one.covered for one in baked) / max(texels, 1),
        psnr=float(-10 * np.log10(np.mean(errors))),
        inner=float(-10 * np.log10(np.concatenate(inside).mean())),
        worst=float(-10 * np.log10(max(errors))),
        black=float(np.concatenate(black).mean()),
        seconds=seconds,
    )


def generate(category: str, seed: int) -> Asset:
    """What the shipped model draws within the boxes of an object, in its paint."""
    structure, appearance = load_structure_model(SHIPPED), load_appearance_model(SHIPPED)
    shape = draw_shape(category, seed)
    asked = describe_shape(shape)
    told = shape_to_asset(shape)
    asset = generate_structure(structure, asked, seed, boxes=told)
    names = [part.name for part in asset.parts]
    surface = repaint(sample_surface(asset), paint_surface(shape, told, SPACING), names)
    shown = generate_appearance(appearance, asset, asked, seed, surface=surface)
    return replace(shown, name=f"{category}_{seed}")


def measure_object(name: str, out: Path) -> list[Row]:
    """Both kinds of meshes of one object, and of one that is generated."""
    category, seed = name.rsplit("_", 1)
    shape = draw_shape(category, int(seed))
    asset = shape_to_asset(shape, spacing=SPACING * frame_shape(shape)[1])
    assert asset.surface is not None
    asset = replace(asset, gaussians=splat_surface(asset.surface))
    exact = {
        visual.part: visual.mesh
        for link in build_reference(shape).links
        for visual in link.visuals
        if isinstance(visual.mesh, Mesh)
    }
    splats: dict[tuple[int, int], np.ndarray] = {}
    drawn = generate(category, int(seed))
    return [
        measure(asset, "exact", [exact[part.name] for part in asset.parts], splats, out),
        measure(asset, "voxels", mesh_parts(asset), splats, out),
        measure(drawn, "generated", mesh_parts(drawn), {}, out),
    ]


def table(rows: Sequence[Row]) -> str:
    """Rows as Markdown."""
    lines = [
        "| object | meshes | covered, % | PSNR, dB | worst picture | on the object | black, % | bake, s |",
        "|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row.name} | {row.meshes} | {100 * row.covered:.2f} | {row.psnr:.1f} | {row.worst:.1f} | "
        f"{row.inner:.1f} | {100 * row.black:.3f} | {row.seconds:.1f} |"
        for row in rows
    ]
    return "\n".join(lines) + "\n"


def main(objects: tuple[str, ...] = OBJECTS, out: Path = Path("out/bake")) -> None:
    """Measures and prints.

    Args:
        objects: Category and seed of each.
        out: Folder for the table and the pictures.
    """
    out.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    for name in objects:
        rows += measure_object(name, out)
        print(table(rows[-3:]), flush=True)
    (out / "table.md").write_text(table(rows))


if __name__ == "__main__":
    tyro.cli(main)
