"""Complete evaluation of an appearance model on held-out procedural objects."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import torch
from tqdm import tqdm, trange

from artigen.appearance.curation import CurationConfig
from artigen.appearance.draw import AppearanceModel, draw_splats, has_appearance, load_appearance_model
from artigen.appearance.extractors import ExtractorConfig, make_extractor
from artigen.appearance.features import FeatureExtractor, PyramidFeatures
from artigen.appearance.inputs import FeatureInputs
from artigen.appearance.paint import lay_painted
from artigen.appearance.photographs import take_pictures
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.appearance.states import plan_fractions
from artigen.appearance.vae import APPEARANCE_VAE, AppearanceVae
from artigen.appearance.views import ViewConfig
from artigen.errors import ArtigenError, SourceError
from artigen.examples.appearance import AppearanceExample, draw_appearance, sample_parts
from artigen.latent.presets import PresetName
from artigen.metrics.appearance import (
    Comparison,
    Scores,
    compare_pictures,
    reconstruct_splats,
    score_colors,
    score_comparisons,
    score_distances,
    score_sets,
    split_states,
)
from artigen.metrics.report import format_score, format_table, write_evaluation
from artigen.metrics.settings import AppearanceViews
from artigen.models.conditions import ConditionConfig, StructureCondition
from artigen.models.description import hash_model, read_description
from artigen.models.rectified_flow import SamplerConfig
from artigen.models.store import load_model
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.types import Asset
from artigen.voxels.layout import Canvas
from artigen.voxels.surface import measure_places

SPACING = 0.02
"""Distance between the true points of surface distances (unit-cube length)."""
ROWS = (
    ("psnr", "PSNR (dB)", "plain"),
    ("ssim", "SSIM", "plain"),
    ("object", "PSNR of the object's pixels", "plain"),
    ("exposed", "of newly exposed pixels", "plain"),
    ("rest", "of its other pixels", "plain"),
    ("exposed_share", "newly exposed share", "percent"),
    ("frechet", "Fréchet distance", "plain"),
    ("kernel", "kernel distance", "plain"),
)
"""Key, name, form."""


@dataclass(frozen=True, kw_only=True)
class EvaluateAppearanceConfig(AppearanceViews):
    """Scope of an evaluation."""

    held_out: int = 14
    """Held-out procedural objects, categories in turn."""
    size: int = 128
    """Edge of a picture in pixels."""
    sampler: SamplerConfig | None = None
    """Steps and guidance; those of the model's preset when None."""
    seed: int = 0
    """Seed of the noise."""


@dataclass(frozen=True, kw_only=True)
class AppearanceEvaluation:
    """All results of an evaluation."""

    model: str
    """Hash of the weights."""
    device: str
    description: dict[str, object]
    """Description of the model, from its folder."""
    config: dict[str, object]
    extractor: str
    """Features of the distances between sets."""
    pictures: int
    """Number of pictures in each of the two sets."""
    total: Scores
    states: dict[str, Scores]
    """Scores by the share of their ranges by which joints are open."""
    objects: dict[str, Scores]
    drawn: Scores
    """Scores of Gaussians sampled on true voxels with their paint; empty without a flow that takes paint."""
    colors: Scores
    """Errors of the mean colours of parts, autoencoded and sampled."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TrainedAppearance:
    """Trained networks, and the settings of their input features."""

    vae: AppearanceVae
    drawer: AppearanceModel | None
    """Model that samples; None if only the VAE was trained."""
    curation: CurationConfig
    extractor: FeatureExtractor
    conditions: ConditionConfig
    description: dict[str, object]


def load_trained(folder: Path, device: torch.device, dinov2: Path | None = None) -> TrainedAppearance:
    """Reads the appearance networks of a model folder.

    Raises:
        SourceError: If the folder holds no VAE, it is of an unknown preset, or its features need weights that
            are not given.
    """
    entry = read_description(folder).get(APPEARANCE_VAE)
    if entry is None:
        raise SourceError(f"{folder}: holds no {APPEARANCE_VAE}; train one, or give the folder of one")
    known: dict[str, PresetName] = {name: name for name in APPEARANCE_PRESETS}
    preset = known.get(str(entry.get("preset")))
    if preset is None:
        raise SourceError(
            f"{folder}: {APPEARANCE_VAE} is of preset {entry.get('preset')!r}, expected one of "
            f"{', '.join(APPEARANCE_PRESETS)}"
        )
    inputs = FeatureInputs(
        preset=preset,
        articulated=bool(entry["articulated"]),
        weighting="plain" if entry["weighting"] == "plain" else "seen",
        features="dinov2" if entry["features"] == "dinov2" else "pyramid",
        dinov2=dinov2,
    )
    vae = AppearanceVae(inputs.encoder, APPEARANCE_PRESETS[preset].decoder)
    load_model(vae, folder, APPEARANCE_VAE)
    return TrainedAppearance(
        vae=vae.to(device),
        drawer=load_appearance_model(folder, device) if has_appearance(folder) else None,
        curation=replace(inputs.curation, kept=0),
        extractor=make_extractor(inputs.extractor),
        conditions=APPEARANCE_PRESETS[preset].conditions,
        description=entry,
    )


def evaluate_appearance(folder: Path, cfg: EvaluateAppearanceConfig) -> AppearanceEvaluation:
    """Autoencodes held-out objects and compares pictures of them in all joint states.

    Raises:
        SourceError: If the folder holds no complete model.
        ArtigenError: If there are too few objects or pictures.
    """
    if min(cfg.held_out, cfg.states, cfg.views) < 1 or cfg.size < 16:
        raise ArtigenError(
            f"{cfg.held_out} objects in {cfg.states} states, {cfg.views} views of {cfg.size} pixels: "
            "expected at least 1 of each, and 16 pixels"
        )
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    model = load_trained(folder, device, cfg.dinov2)
    if cfg.dinov2 is None:
        extractor: FeatureExtractor = PyramidFeatures()
    else:
        extractor = make_extractor(ExtractorConfig(name="dinov2", folder=cfg.dinov2))
    comparisons: dict[str, Comparison] = {}
    distances: dict[str, Scores] = {}
    subjects: list[tuple[Asset, AppearanceExample]] = []
    for number in trange(cfg.held_out, desc="held-out objects", disable=None):
        asset, example = draw_subject(model, number, cfg)
        subjects.append((asset, example))
        splats = reconstruct_splats(model.vae, example)
        comparisons[example.name] = compare_pictures(model.vae, splats, example)
        surface = sample_parts(_draw_again(asset), asset, SPACING)
        distances[example.name] = score_distances(
            splats, example.part_ids, surface, example.pictures.displacements
        )
    every = list(comparisons.values())
    drawn = _compare_drawn(model, subjects, cfg)
    answers = {"autoencoded": every} | ({"drawn": drawn} if drawn else {})
    return AppearanceEvaluation(
        model=hash_model(folder),
        device=str(device),
        description=model.description,
        config={**asdict(cfg), "dinov2": cfg.dinov2 is not None},
        extractor=extractor.name,
        pictures=sum(len(one.drawn) for one in every),
        total=score_comparisons(every) | score_sets(every, extractor) | _mean(list(distances.values())),
        states={
            f"{share:.2f}": score_comparisons(some) | score_sets(some, extractor)
            for share, some in split_states(every).items()
        },
        objects={name: score_comparisons([one]) | distances[name] for name, one in comparisons.items()},
        drawn=score_comparisons(drawn),
        colors=score_colors([example for _, example in subjects], answers),
    )


def draw_subject(
    model: TrainedAppearance, number: int, cfg: EvaluateAppearanceConfig
) -> tuple[Asset, AppearanceExample]:
    """A held-out object with the input features of the model, and the pictures on which it is scored."""
    categories = model.conditions.categories
    category, seed = categories[number % len(categories)], number // len(categories)
    asset, example = draw_appearance(
        category,
        seed,
        model.extractor,
        model.curation,
        resolution=model.vae.encoder.cfg.resolution,
        image_size=model.conditions.image_size,
    )
    shape = draw_shape(category, seed)
    views = ViewConfig(count=cfg.views, size=cfg.size, sharpness=2)
    fractions = plan_fractions(shape, cfg.states, staggered=False)
    return asset, replace(example, pictures=take_pictures(shape, asset, fractions, views))


def _draw_again(asset: Asset) -> Shape:
    """The procedural object of an asset, which is named after its category and seed."""
    category, seed = asset.name.rsplit("_", 1)
    return draw_shape(category, int(seed))


def _mean(scores: list[Scores]) -> Scores:
    return {name: float(np.mean([one[name] for one in scores])) for name in scores[0]}


def _compare_drawn(
    model: TrainedAppearance,
    subjects: Sequence[tuple[Asset, AppearanceExample]],
    cfg: EvaluateAppearanceConfig,
) -> list[Comparison]:
    """Pictures of Gaussians that the flow samples on true voxels, given nothing but their true paint.

    Empty without a flow that takes paint.
    """
    if model.drawer is None or not model.drawer.flow.attribute_channels:
        return []
    out = []
    for asset, example in tqdm(subjects, "draws", disable=None):
        laid, facings, _ = lay_painted(_draw_again(asset), asset)
        assert laid.voxels is not None
        assert laid.surface is not None
        canvas = Canvas(
            coords=laid.voxels.coords,
            part_ids=laid.voxels.part_ids,
            facings=facings,
            table=example.table,
            places=measure_places(laid.surface, laid.voxels, facings),
        )
        splats = draw_splats(
            model.drawer,
            canvas,
            StructureCondition(),
            cfg.seed,
            paint=(example.paint / 255.0).astype(np.float32),
            sampler=cfg.sampler,
        )
        out.append(compare_pictures(model.vae, splats, example))
    return out


def write_appearance_report(evaluation: AppearanceEvaluation, out: Path) -> tuple[Path, Path]:
    """Writes ``evaluation.json`` and ``evaluation.md``, each whole or not at all."""
    return write_evaluation(asdict(evaluation), format_appearance(evaluation), out)


def format_appearance(evaluation: AppearanceEvaluation) -> str:
    """Markdown tables: one row per joint state and one for all, sampled Gaussians, colours of parts."""
    described = ", ".join(f"{name} {value}" for name, value in sorted(evaluation.description.items()))
    rows = {**evaluation.states, "all": evaluation.total}
    lines = [f"Model {evaluation.model[:12]} ({described}), device {evaluation.device}.", ""]
    lines += ["## Autoencoded held-out objects", ""]
    lines += format_table(
        ("joints open by", *(name for _, name, _ in ROWS)),
        [
            (share, *(format_score(scores.get(key), form) for key, _, form in ROWS))
            for share, scores in rows.items()
        ],
    )
    lines += [
        "",
        f"{len(evaluation.objects)} objects, {evaluation.pictures} pictures in each of the two sets. PSNR is",
        f"a mean over objects. Distances between sets are those of {evaluation.extractor} features: compare",
        "them only with results that have the same features and as many pictures.",
    ]
    lines += [
        "",
        f"Gaussians to the true surface (Chamfer, squared, unit cube, whole object): closed (RS) "
        f"{evaluation.total['shape_rest']:.4g}, mean over states (AS) "
        f"{evaluation.total['shape_articulated']:.4g}.",
    ]
    if evaluation.drawn:
        keys = [row for row in ROWS if row[0] in ("psnr", "ssim", "object", "exposed", "rest")]
        lines += ["", "## Sampled on true voxels", ""]
        lines += format_table(
            ("given", *(name for _, name, _ in keys)),
            [("paint", *(format_score(evaluation.drawn.get(key), form) for key, _, form in keys))],
        )
    lines += ["", "## Colours of parts", ""]
    lines += format_table(
        ("Gaussians are", "error of the mean colour of a part"),
        [(name, format_score(value, "plain")) for name, value in evaluation.colors.items()],
    )
    lines += [
        "",
        "Mean absolute difference of sRGB values in [0, 1], over the parts that the closed object shows.",
        "Sampled Gaussians are those of the flow on the true voxels, given the paint of both of their sides.",
    ]
    return "\n".join(lines) + "\n"
