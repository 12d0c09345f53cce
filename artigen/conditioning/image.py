"""What a picture says of an object: category, part counts and proportions, by the picture reader."""

from dataclasses import replace
from pathlib import Path

from artigen.errors import SourceError
from artigen.models.conditions import StructureCondition
from artigen.models.picture_reader import PictureReader, read_condition
from artigen.models.presets import PRESETS
from artigen.models.store import load_model, read_description
from artigen.pictures import read_picture
from artigen.sketch.request import SketchRequest

READER = "reader"
"""Of the network in a model folder."""


def load_reader(folder: Path) -> PictureReader:
    """Loads the picture reader of a model folder.

    Raises:
        SourceError: If the folder holds none.
    """
    name = read_description(folder).get(READER, {}).get("preset")
    preset = next((known for key, known in PRESETS.items() if key == name), None)
    if preset is None or preset.reader is None:
        raise SourceError(f"{folder}: holds no picture reader; train one with artigen train structure-reader")
    reader = PictureReader(preset.reader, preset.conditions)
    load_model(reader, folder, READER)
    return reader


def read_image(
    reader: PictureReader, path: Path, request: SketchRequest
) -> tuple[SketchRequest, tuple[str, ...]]:
    """Fills what a request leaves open with what a picture shows, and says what that was.

    A picture shows proportions, not metres: lengths are those of usual objects, scaled to one that is asked
    for.

    Args:
        reader: trained.
        path: the picture.
        request: what is asked for besides.

    Raises:
        SourceError: If the picture cannot be read.
    """
    picture = read_picture(path, reader.conditions.image_size, margin=reader.conditions.image_margin)
    asked = StructureCondition(category=request.category, counts=request.counts, image=picture.rgba)
    read, notes = read_condition(reader, asked)
    assert read.size is not None
    given = (request.depth, request.width, request.height)
    scales = [asked / seen for asked, seen in zip(given, read.size, strict=True) if asked is not None]
    scale = sum(scales) / len(scales) if scales else 1.0
    depth, width, height = (
        scale * seen if asked is None else asked for asked, seen in zip(given, read.size, strict=True)
    )
    whole = replace(
        request, category=read.category, counts=read.counts, depth=depth, width=width, height=height
    )
    return whole, notes
