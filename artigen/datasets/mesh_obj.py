"""Meshes of trimesh as OBJ files with plain colours and images."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from PIL.Image import Image
    from trimesh import Trimesh

COLORS = 64
"""Most plain colours that one mesh keeps; more are averaged."""


def write_obj(
    pieces: Sequence["Trimesh"],
    color: tuple[float, float, float, float],
    target: Path,
    default: "Image | None" = None,
) -> None:
    """Writes meshes as one OBJ, with plain colours and images.

    Args:
        color: RGBA of meshes without any.
        default: Image of these.
    """
    rows, materials, start, texture = [f"mtllib {target.stem}.mtl"], [], 1, 1
    for piece in pieces:
        uv, image, colors, numbers = _find_look(piece, color, default)
        rows += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in piece.vertices.tolist()]
        rows += [f"vt {u:.7g} {v:.7g}" for u, v in ([] if uv is None else uv.tolist())]
        first = len(materials)
        for red, green, blue, opacity in colors:
            material = f"newmtl m{len(materials)}\nKd {red:.5g} {green:.5g} {blue:.5g}"
            if opacity < 1.0:
                material += f"\nd {opacity:.5g}"
            if image is not None:
                material += f"\nmap_Kd {_write_image(image, target.parent)}"
            materials.append(material)
        for number in range(len(colors)):
            rows.append(f"usemtl m{first + number}")
            for face in piece.faces[numbers == number].tolist():
                corners = [(start + k, "" if uv is None else f"/{texture + k}") for k in face]
                rows.append("f " + " ".join(f"{vertex}{coord}" for vertex, coord in corners))
        start += len(piece.vertices)
        texture += 0 if uv is None else len(uv)
    target.write_text("\n".join(rows) + "\n", encoding="utf-8")
    target.with_suffix(".mtl").write_text("\n".join(materials) + "\n", encoding="utf-8")


def _write_image(image: "Image", folder: Path) -> str:
    """Name of a PNG of an image, which is there once however often it is used."""
    pixels = image.convert("RGB")
    size = f"{pixels.width} {pixels.height} ".encode()
    name = f"image_{hashlib.sha256(size + pixels.tobytes()).hexdigest()[:16]}.png"
    if not (folder / name).exists():
        pixels.save(folder / name, compress_level=1)
    return name


def _find_look(
    piece: "Trimesh", color: tuple[float, float, float, float], default: "Image | None"
) -> tuple[np.ndarray | None, "Image | None", list[tuple[float, ...]], np.ndarray]:
    """Texture coordinates and image if there is one, plain colours (RGBA), and the colour of each face.

    A material of the mesh is transparent only if it says so: glTF ignores the alpha of others. An image is
    multiplied by the colour that glTF gives it.
    """
    from PIL import Image
    from trimesh.visual.material import empty_material

    visual: Any = piece.visual
    one = np.zeros(len(piece.faces), dtype=np.int64)
    if visual.kind in ("face", "vertex"):
        faces = np.asarray(visual.face_colors)[:, :3] / 255
        plain, numbers = np.unique(faces, axis=0, return_inverse=True)
        if len(plain) > COLORS:
            return None, None, [(*faces.mean(axis=0).tolist(), 1.0)], one
        return None, None, [(*row, 1.0) for row in plain.tolist()], numbers.ravel()
    material = visual.material if visual.kind == "texture" else None
    if hash(material) == hash(empty_material()):  # what trimesh has where a file says nothing
        material = None
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    factor = getattr(material, "baseColorFactor", None)
    said = factor is not None or hasattr(material, "diffuse")
    textured = visual.kind == "texture" and visual.uv is not None
    uv = np.asarray(visual.uv, dtype=np.float64) if textured else None
    main = np.asarray(material.main_color) / 255 if material is not None and said else np.array(color)
    if image is None and not said:
        image = default
    blends = not said or getattr(material, "alphaMode", None) == "BLEND"
    opacity = float(main[3]) if blends else 1.0
    times = main[:3] if factor is not None or not said else np.ones(3)
    if image is None:
        return None, None, [(*main[:3].tolist(), opacity)], one
    pixels = np.asarray(image.convert("RGB"))
    if uv is None:
        mean = pixels.reshape(-1, 3).mean(axis=0) / 255.0
        return None, None, [(*(times * mean).tolist(), opacity)], one
    if not (times == 1.0).all():
        image = Image.fromarray(np.round(pixels * times).astype(np.uint8))
    return uv, image, [(1.0, 1.0, 1.0, opacity)], one
