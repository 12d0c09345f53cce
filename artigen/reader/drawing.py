"""Draws a reading over its photograph."""

from typing import TYPE_CHECKING

from artigen.reader.reading import Reading

if TYPE_CHECKING:
    from PIL import Image

EDGE = 1024
"""Longest edge (pixels) of the drawing."""
COLORS = {
    "door": (30, 110, 255), "drawer": (30, 170, 60), "handle": (230, 40, 40), "knob": (220, 40, 220),
    "shelf": (150, 130, 20), "wheel": (20, 170, 180),
}  # fmt: skip


def draw_reading(image: "Image.Image", reading: Reading) -> "Image.Image":
    """The picture over white, with the boxes of all parts and what was read of them."""
    from PIL import Image, ImageDraw, ImageFont

    scale = min(1.0, EDGE / max(image.size))
    size = (max(1, round(image.width * scale)), max(1, round(image.height * scale)))
    out = Image.new("RGB", size, (255, 255, 255))
    out.paste(image.convert("RGB").resize(size), (0, 0), image.getchannel("A").resize(size))
    pen, font = ImageDraw.Draw(out), ImageFont.load_default(max(11, max(size) // 50))
    line = max(1, max(size) // 300)

    def to_pixels(points: list[list[float]]) -> list[tuple[float, float]]:
        return [(x * size[0], y * size[1]) for x, y in points]

    def write(place: tuple[float, float], text: str, color: tuple[int, int, int]) -> None:
        pen.rectangle(pen.textbbox(place, text, font=font), fill=(255, 255, 255))
        pen.text(place, text, fill=color, font=font)

    corner = to_pixels(reading.box.reshape(2, 2).tolist())
    pen.rectangle((*corner[0], *corner[1]), outline=(120, 120, 120), width=line)
    for part in reading.parts:
        color = COLORS[part.label]
        box = to_pixels(part.box.reshape(2, 2).tolist())
        if part.corners is not None and part.label in ("door", "drawer"):
            pen.polygon(to_pixels(part.corners.tolist()), outline=color, width=1)
        pen.rectangle((*box[0], *box[1]), outline=color, width=line)
        if part.label in ("door", "drawer"):
            said = (
                part.label
                + ("" if part.hinge is None else f", {part.hinge}")
                + (", open" if part.open else "")
            )
            write((box[0][0] + 2 * line, box[0][1] + 2 * line), said, color)
    kind, share = reading.kinds[0]
    write((2, 2), f"{kind} {share:.0%}", (0, 0, 0))
    return out
