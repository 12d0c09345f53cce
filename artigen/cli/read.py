"""`artigen read`: says what is in a photograph, or what a sentence asks for."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from artigen.errors import ArtigenError

if TYPE_CHECKING:
    from artigen.reader.reading import Reading

Json = Annotated[bool, tyro.conf.arg(name="json")]
PICTURES = (".png", ".jpg", ".jpeg", ".webp")


def read(
    photo: tyro.conf.Positional[Path | None] = None,
    text: str | None = None,
    box: tuple[float, float, float, float] | None = None,
    as_json: Json = False,  # noqa: FBT002 - a flag of the command line
    picture: Path | None = None,
) -> int:
    """Read a photograph (kind, doors, drawers, handles, size and colours of one object) or a sentence.

    Args:
        photo: Photograph of a piece of furniture or an appliance, from near its front.
        text: A sentence as for ``artigen generate --text``, read without drawing anything.
        box: Left, top, right and bottom of the object to read, as shares of width and height; default: the
            largest object.
        as_json: Print the reading as JSON.
        picture: File to write, such as boxes.png: the photograph with the boxes of all parts.
    """
    if (photo is None) == (text is None):
        raise ArtigenError("expected a photograph or --text WORDS, and not both")
    if text is not None:
        return _read_words(text, as_json=as_json)
    assert photo is not None
    from artigen.conditioning.image import open_picture
    from artigen.reader.drawing import draw_reading
    from artigen.reader.read import read_photo

    if picture is not None and picture.suffix.lower() not in PICTURES:
        raise ArtigenError(f"{picture}: expected a file that ends with {', '.join(PICTURES)}")
    reading = read_photo(photo, box=box)
    if picture is not None:
        picture.parent.mkdir(parents=True, exist_ok=True)
        draw_reading(open_picture(photo), reading).save(picture)
    sys.stdout.write(json.dumps(reading.to_json(), indent=1) + "\n" if as_json else describe(reading))
    return 0


def _read_words(text: str, *, as_json: bool) -> int:
    from artigen.conditioning.read import read_sentence

    sentence = read_sentence(text)
    said = json.dumps(sentence.to_json(), indent=1) if as_json else sentence.describe()
    sys.stdout.write(said + "\n")
    return 0


def describe(reading: "Reading") -> str:
    """A reading in a few lines."""
    from artigen.reader.reading import to_hex

    likely = ", ".join(f"{kind} {share:.0%}" for kind, share in reading.kinds[:3])
    width, depth, height = reading.size
    lines = [f"{reading.kind} ({likely})"]
    if not reading.sure:
        lines[0] = f"not sure: {likely}"
    counts = ", ".join(
        f"{count} {label}{'s' * (count != 1)}" for label, count in reading.counts.items() if count
    )
    lines.append(f"in view: {counts or 'no doors, drawers, handles or knobs'}")
    for front in reading.fronts:
        left, top, right, bottom = front.box
        said = [front.label, f"{left:.2f} {top:.2f} {right:.2f} {bottom:.2f}"]
        said += [f"hinges {front.hinge}"] if front.hinge else []
        said += ["open"] if front.open else []
        said += ["glazed"] if front.pane else []
        said += [front.material] if front.material else []
        said += [to_hex(front.color)] if front.color else []
        lines.append("  " + ", ".join(said))
    lines.append(
        f"about {width:.2f} m wide, {depth:.2f} m deep, {height:.2f} m high, on {_name_stand(reading.stand)}"
    )
    lines += [f"note: {note}" for note in reading.notes]
    return "\n".join(lines) + "\n"


def _name_stand(stand: str) -> str:
    return {"flat": "its base", "legs": "legs", "wheels": "wheels"}[stand]
