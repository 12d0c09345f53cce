"""What the sparse flow draws on true voxels: does it look like the object, and follow its picture?"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from artigen.appearance import AppearanceConfig, AppearanceModel, draw_splats
from artigen.errors import SourceError
from artigen.metrics.appearance import (
    Comparison,
    Scores,
    compare_pictures,
    reconstruct_splats,
    score_comparisons,
)
from artigen.metrics.part_colors import Colors, borrow_colors, color_error, mean_colors
from artigen.metrics.retrieval import retrieve
from artigen.metrics.subjects import Subject
from artigen.models.appearance_vae import AppearanceVae
from artigen.models.conditions import StructureCondition
from artigen.shapes.draw import draw_shape
from artigen.train.appearance.examples import AppearanceExample
from artigen.train.appearance.photographs import Pictures, take_pictures
from artigen.train.appearance.views import ViewConfig
from artigen.types import Asset


@dataclass(frozen=True, kw_only=True, eq=False)
class PictureTask:
    """A held-out object, and all that is asked about it is its picture."""

    asset: Asset
    example: AppearanceExample
    """Its pictures are those that colours are read off."""


def score_colors(
    vae: AppearanceVae,
    model: AppearanceModel,
    tasks: list[PictureTask],
    library: list[Subject],
    cfg: AppearanceConfig,
    seed: int,
    *,
    on_done: Callable[[], None] | None = None,
) -> Scores:
    """Mean absolute error of the mean colour of each part that the closed object shows, over objects.

    ``model`` draws under the picture alone, on the true voxels; ``autoencoded`` knows the object;
    ``retrieval`` takes the colours of the library's object with the most similar picture.

    Raises:
        SourceError: If an example has no picture.
    """
    rows: dict[str, list[float]] = {"model": [], "autoencoded": [], "retrieval": []}
    for task in tasks:
        example = _closed(task.example)
        asked = _ask_picture(example)
        truth = mean_colors(example.pictures.rgb / 255.0, example.pictures.parts)
        answers = {
            "model": draw_splats(model, example.coords, example.part_ids, example.table, asked, seed, cfg),
            "autoencoded": reconstruct_splats(vae, example),
        }
        for name, splats in answers.items():
            drawn = compare_pictures(vae, splats, example).drawn.double().numpy()
            rows[name].append(color_error(mean_colors(drawn, example.pictures.parts), truth))
        found = retrieve(asked, library)
        lent = _colors_of(
            found, ViewConfig(count=len(example.pictures.rgb), size=example.pictures.rgb.shape[1])
        )
        borrowed = borrow_colors(truth, task.asset.parts, lent, found.asset.parts)
        rows["retrieval"].append(color_error(borrowed, truth))
        if on_done is not None:
            on_done()
    return {name: float(np.mean(values)) for name, values in rows.items() if values}


def score_draws(
    vae: AppearanceVae,
    model: AppearanceModel,
    tasks: list[PictureTask],
    cfg: AppearanceConfig,
    seed: int,
    *,
    on_done: Callable[[], None] | None = None,
) -> dict[str, Scores]:
    """Pictures of drawn Gaussians beside the true ones, in all joint states.

    ``palettes`` is told the colours of the parts and draws what is made of them; ``picture`` is told one
    picture and nothing else. Between the first and the autoencoded object lies what the flow does not know,
    between both what the palettes do not.
    """
    comparisons: dict[str, list[Comparison]] = {}
    for task in tasks:
        example = task.example
        asked: dict[str, tuple[StructureCondition, np.ndarray | None]] = {}
        if model.palette is not None:
            asked["palettes"] = (StructureCondition(), example.palettes)
        if example.image is not None:
            asked["picture"] = (_ask_picture(example), None)
        for name, (condition, palettes) in asked.items():
            splats = draw_splats(
                model,
                example.coords,
                example.part_ids,
                example.table,
                condition,
                seed,
                cfg,
                palettes=palettes,
            )
            comparisons.setdefault(name, []).append(compare_pictures(vae, splats, example))
        if on_done is not None:
            on_done()
    return {name: score_comparisons(some) for name, some in comparisons.items()}


def _ask_picture(example: AppearanceExample) -> StructureCondition:
    """The picture of an example, and nothing else.

    Raises:
        SourceError: If it has none.
    """
    if example.image is None:
        raise SourceError(f"{example.name}: has no picture to ask with")
    return StructureCondition(image=example.image.transpose(2, 0, 1).astype(np.float32) / 255.0)


def _closed(example: AppearanceExample) -> AppearanceExample:
    """The example with the pictures of its closed state alone."""
    pictures = example.pictures
    rows = pictures.state == 0
    kept = {name: value if name == "displacements" else value[rows] for name, value in vars(pictures).items()}
    return replace(example, pictures=Pictures(**kept))


def _colors_of(subject: Subject, views: ViewConfig) -> Colors:
    """Colours of a procedural object's parts, from photographs of the closed object."""
    category, seed = subject.asset.name.rsplit("_", 1)
    shape = draw_shape(category, int(seed))
    pictures = take_pictures(shape, subject.asset, np.zeros((1, len(shape.parts))), views)
    return mean_colors(pictures.rgb / 255.0, pictures.parts)
