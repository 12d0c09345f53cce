"""What the sparse flow draws on true voxels: does it look like the object, and follow its picture?"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from artigen.appearance import AppearanceConfig, AppearanceModel, Told, draw_splats
from artigen.canvas import Canvas
from artigen.errors import SourceError
from artigen.metrics.appearance import Comparison, Scores, compare_pictures
from artigen.metrics.part_colors import Colors, borrow_colors, color_error, mean_colors
from artigen.metrics.retrieval import retrieve
from artigen.metrics.subjects import Subject
from artigen.models.appearance_vae import AppearanceVae
from artigen.models.conditions import StructureCondition
from artigen.places import measure_places
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.train.appearance.examples import AppearanceExample, lay_true_voxels
from artigen.train.appearance.photographs import take_pictures
from artigen.train.appearance.views import ViewConfig
from artigen.types import Asset


@dataclass(frozen=True, kw_only=True, eq=False)
class PictureTask:
    """A held-out object, and all that is asked about it is its picture."""

    asset: Asset
    example: AppearanceExample
    """Its pictures are those that colours are read off."""


def compare_draws(
    vae: AppearanceVae,
    model: AppearanceModel,
    tasks: list[PictureTask],
    cfg: AppearanceConfig,
    seed: int,
    *,
    on_done: Callable[[], None] | None = None,
) -> dict[str, list[Comparison]]:
    """Pictures of drawn Gaussians beside the true ones, in all joint states, object by object.

    ``paint`` is told the colours of both sides of every voxel, ``palettes`` those of the parts, ``picture``
    one picture and nothing else. Between the autoencoded object and the first lies what the flow does not
    know, between the others what the painter does not, and what the palettes do not.
    """
    comparisons: dict[str, list[Comparison]] = {}
    for task in tasks:
        example = task.example
        canvas = _make_canvas(task)
        asked: dict[str, tuple[StructureCondition, Told]] = {}
        if model.palette is not None:
            asked["paint"] = (StructureCondition(), Told(paint=example.paint / 255.0))
            asked["palettes"] = (StructureCondition(), Told(palettes=example.palettes))
        if example.image is not None:
            asked["picture"] = (_ask_picture(example), Told())
        for name, (condition, told) in asked.items():
            splats = draw_splats(model, canvas, condition, seed, cfg, told=told)
            comparisons.setdefault(name, []).append(compare_pictures(vae, splats, example))
        if on_done is not None:
            on_done()
    return comparisons


def score_colors(
    tasks: list[PictureTask],
    answers: Mapping[str, Sequence[Comparison]],
    library: list[Subject],
    *,
    on_done: Callable[[], None] | None = None,
) -> Scores:
    """Mean absolute error of the mean colour of each part that the closed object shows, over objects.

    Args:
        tasks: the objects.
        answers: pictures of each object, by method.
        library: ``retrieval`` takes the colours of that object of it whose picture is most similar.
        on_done: called after each object.

    Raises:
        SourceError: If an example has no picture.
    """
    rows: dict[str, list[float]] = {name: [] for name in (*answers, "retrieval")}
    for number, task in enumerate(tasks):
        example = task.example
        closed = example.pictures.state == 0
        parts, rgb = example.pictures.parts[closed], example.pictures.rgb[closed]
        truth = mean_colors(rgb / 255.0, parts)
        for name, comparisons in answers.items():
            drawn = comparisons[number].drawn.double().numpy()[closed]
            rows[name].append(color_error(mean_colors(drawn, parts), truth))
        found = retrieve(_ask_picture(example), library)
        lent = _colors_of(found, ViewConfig(count=len(rgb), size=rgb.shape[1]))
        borrowed = borrow_colors(truth, task.asset.parts, lent, found.asset.parts)
        rows["retrieval"].append(color_error(borrowed, truth))
        if on_done is not None:
            on_done()
    return {name: float(np.mean(values)) for name, values in rows.items() if values}


def _make_canvas(task: PictureTask) -> Canvas:
    """The true voxels of an object, and where its own surface lies in them."""
    laid, facings = lay_true_voxels(_shape_of(task.asset), task.asset)
    assert laid.voxels is not None
    assert laid.surface is not None
    return Canvas(
        coords=laid.voxels.coords,
        part_ids=laid.voxels.part_ids,
        facings=facings,
        table=task.example.table,
        places=measure_places(laid.surface, laid.voxels, facings),
    )


def _shape_of(asset: Asset) -> Shape:
    """The procedural object that an asset is named after."""
    category, seed = asset.name.rsplit("_", 1)
    return draw_shape(category, int(seed))


def _ask_picture(example: AppearanceExample) -> StructureCondition:
    """The picture of an example, and nothing else.

    Raises:
        SourceError: If it has none.
    """
    if example.image is None:
        raise SourceError(f"{example.name}: has no picture to ask with")
    return StructureCondition(image=example.image.transpose(2, 0, 1).astype(np.float32) / 255.0)


def _colors_of(subject: Subject, views: ViewConfig) -> Colors:
    """Colours of a procedural object's parts, from photographs of the closed object."""
    shape = _shape_of(subject.asset)
    pictures = take_pictures(shape, subject.asset, np.zeros((1, len(shape.parts))), views)
    return mean_colors(pictures.rgb / 255.0, pictures.parts)
