"""`write_comparison`: a page with a photograph, what was read, and the object seen from the same place."""

import base64
import html
import io
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from artigen.camera import Camera
from artigen.reader.drawing import draw_reading
from artigen.reader.layout.overlay import MET, Overlay, lay_over
from artigen.reader.reading import Reading, ReadPart
from artigen.shapes.shape import Shape

if TYPE_CHECKING:
    from PIL import Image

    from artigen.shapes.render import RenderConfig

EDGE = 560
"""Longest edge (pixels) of the pictures."""
LARGEST = 3.0
"""Largest picture to render, relative to the photograph: one whose middle is the camera's axis."""
PALE = 0.75
"""Share of white in the photograph behind the object."""


def write_comparison(
    path: Path, image: "Image.Image", reading: Reading, shape: Shape, notes: Sequence[str] = ()
) -> Overlay:
    """Writes the page, one file that opens in any browser without a network.

    Args:
        path: File to write, ending in ``.html``.
        image: The photograph.
        reading: What was read of it, with corrections.
        shape: The object that was built.
        notes: What to say below.

    Returns:
        The object over the photograph, as shown.
    """
    photo = image.convert("RGBA")
    photo.thumbnail((EDGE, EDGE))
    overlay = lay_over(reading, shape)
    seen = draw_over(photo, scale_camera(overlay.camera, photo.size), shape)
    marked = draw_reading(photo, reading).resize(photo.size)
    rows = "".join(map(_describe_front, reading.fronts, overlay.met))
    said = "".join(f"<li>{html.escape(note)}</li>" for note in notes)
    page = PAGE.format(
        title=html.escape(f"{shape.category}: photograph and object"),
        width=photo.width,
        height=photo.height,
        photo=_embed(photo),
        marked=_embed(marked),
        object=_embed(seen),
        rows=rows,
        notes=said,
        reading=html.escape(json.dumps(reading.to_json(), indent=1)),
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page)
    return overlay


def _describe_front(part: ReadPart, met: float) -> str:
    """A row of the table."""
    box = " ".join(f"{value:.2f}" for value in part.box)
    cells = (part.label, part.hinge or "", box, f"{part.score:.0%}")
    well = "good" if met >= MET else "bad"
    return "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + f"<td class={well}>{met:.0%}</td></tr>"


def scale_camera(camera: Camera, size: tuple[int, int]) -> Camera:
    """The camera of the same picture in other pixels."""
    width, height = size
    return replace(camera, pixel=camera.pixel * camera.width / width, width=width, height=height)


@dataclass(frozen=True, kw_only=True, eq=False)
class Seen:
    """An object in the pixels of a photograph."""

    rgb: Float[np.ndarray, "H W 3"]
    """sRGB in [0, 1]."""
    mask: Bool[np.ndarray, "H W"]
    part_ids: Int[np.ndarray, "H W"]
    """Index into the shape's parts, -1 where there is none."""


def render_over(camera: Camera, shape: Shape, cfg: "RenderConfig | None" = None) -> Seen:
    """The closed object in a photograph.

    Args:
        camera: Its axes may be sheared, as those of `Overlay.camera`.
        shape: The object.
        cfg: Light; default: that of a room.
    """
    from artigen.shapes.render import batch_cameras, build_scene, render

    straight, (left, top) = straighten(camera)
    seen = render(build_scene([shape]), batch_cameras([straight]), [np.zeros(len(shape.parts))], cfg=cfg)
    rgb, mask, part_ids = (
        held[0].numpy()[top : top + camera.height, left : left + camera.width]
        for held in (seen.rgb, seen.mask, seen.part_ids)
    )
    return Seen(rgb=rgb.astype(np.float64), mask=mask, part_ids=part_ids)


def draw_over(photo: "Image.Image", camera: Camera, shape: Shape) -> "Image.Image":
    """The closed object before a pale photograph of the camera's size.

    Args:
        photo: RGBA.
        camera: Its axes may be sheared, as those of `Overlay.camera`.
        shape: The object.
    """
    from PIL import Image

    seen = render_over(camera, shape)
    paper = Image.new("RGB", photo.size, (255, 255, 255))
    paper.paste(photo.convert("RGB"), (0, 0), photo.getchannel("A"))
    ground = np.asarray(paper, dtype=np.float64) / 255.0
    out = ground + PALE * (1.0 - ground)
    out[seen.mask] = seen.rgb[seen.mask]
    pixels: UInt8[np.ndarray, "H W 3"] = np.round(255.0 * out).astype(np.uint8)
    return Image.fromarray(pixels)


def straighten(camera: Camera) -> tuple[Camera, tuple[int, int]]:
    """A camera whose axis goes through the middle of a larger picture, and where the picture begins in that.

    Of axes that are very far off, the picture is cut at `LARGEST` times the size.
    """
    forward = camera.axes[2]
    shear = camera.axes[:2] @ forward
    size = np.array([camera.width, camera.height])
    middle = size / 2 + shear / camera.pixel
    middle = np.clip(np.round(middle), size * (1 - LARGEST / 2), size * LARGEST / 2)
    half = [ceil(value) for value in np.maximum(middle, size - middle)]
    axes: Float[np.ndarray, "3 3"] = camera.axes.copy()
    axes[:2] -= np.outer(shear, forward)
    straight = replace(camera, axes=axes, width=2 * half[0], height=2 * half[1])
    return straight, (half[0] - int(middle[0]), half[1] - int(middle[1]))


def _embed(image: "Image.Image") -> str:
    """A picture as the address of itself."""
    held = io.BytesIO()
    image.convert("RGB").save(held, "JPEG", quality=88)
    return f"data:image/jpeg;base64,{base64.b64encode(held.getvalue()).decode()}"


PAGE = """<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{title}</title>
<style>
body {{ font: 15px system-ui, sans-serif; margin: 2em auto; max-width: {width}px; color: #222 }}
.view {{ position: relative; width: {width}px; max-width: 100%; aspect-ratio: {width} / {height} }}
.view img {{ position: absolute; width: 100%; height: 100% }}
#object {{ clip-path: inset(0 0 0 50%) }}
input[type=range] {{ width: 100% }}
table {{ border-collapse: collapse; margin-top: 1em }} td, th {{ padding: .2em .8em; text-align: left }}
.good {{ color: #17722c }} .bad {{ color: #b3261e }}
</style>
<h1>{title}</h1>
<div class="view"><img src="{photo}" alt="the photograph">
<img id="marked" src="{marked}" alt="what was read" hidden>
<img id="object" src="{object}" alt="the object from the same place"></div>
<input type="range" min="0" max="100" value="50" aria-label="photograph to object"
 oninput="document.getElementById('object').style.clipPath='inset(0 0 0 ' + this.value + '%)'">
<label><input type="checkbox" onchange="document.getElementById('marked').hidden = !this.checked">
what was read</label>
<table><tr><th>front</th><th>hinges</th><th>left top right bottom</th><th>score</th>
<th>overlap with that of the object</th></tr>
{rows}</table>
<ul>{notes}</ul>
<p>To correct it, say so: <code>--doors</code>, <code>--drawers</code>, <code>--width</code>,
<code>--kind</code>, <code>--box</code>, or <code>--text "hinges on the left"</code>. Or edit what was read,
<a id="save" download="reading.json" href="#">save it</a>, and draw it again with
<code>artigen generate --reading reading.json -o out/edited</code>:</p>
<textarea id="reading" rows="24" style="width: 100%" spellcheck="false"
 aria-label="what was read">{reading}</textarea>
<script>
document.getElementById('save').addEventListener('click', event => {{
  const text = document.getElementById('reading').value;
  event.target.href = 'data:application/json;charset=utf-8,' + encodeURIComponent(text);
}});
</script>
</html>
"""
