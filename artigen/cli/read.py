"""`artigen read`: says what is in a photograph, or what a sentence asks for."""

import json
import sys
from pathlib import Path
from typing import Annotated

import tyro

from artigen.errors import ArtigenError

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
    from artigen.reader.describe import describe
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
