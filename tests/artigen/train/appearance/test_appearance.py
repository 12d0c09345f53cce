"""What appearance is learnt from: joint states, visible features, exposed pixels; and that it is learnt."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from drawer_chest import COLOR, INSIDE, LIGHT, make_cabinet, make_chest, make_example, small_curation

import artigen.train.loop
from artigen.appearance.exposure import find_exposed
from artigen.appearance.gaussian_decoder import GaussianConfig, GaussianDecoderConfig
from artigen.appearance.inputs import close_curation
from artigen.appearance.paint import PAINT, VoxelPaint
from artigen.appearance.photographs import look_at_surface, photograph, take_pictures
from artigen.appearance.sides import FEW, SURE, SideMean, see_alike
from artigen.appearance.slat_flow import SlatFlow
from artigen.appearance.slat_patch_dit import SlatPatchDitConfig
from artigen.appearance.slat_vae import SlatVaeConfig
from artigen.appearance.states import asset_coordinates, plan_fractions, shape_coordinates
from artigen.appearance.vae import COLOR_MIDDLE, COLOR_SPREAD, SIDE_CHANNELS, AppearanceVae, Encoded
from artigen.appearance.views import ViewConfig, place_cameras, spread_directions
from artigen.appearance.visibility import SeenVoxels
from artigen.examples.appearance import (
    PER_VOXEL,
    AppearanceExample,
    read_appearance_shard,
    write_appearance_shard,
)
from artigen.examples.appearance_batches import (
    PictureBatch,
    draw_picture_batches,
    draw_pictures,
    picture_batch,
    raster_config,
)
from artigen.examples.shards import PER_OBJECT
from artigen.models.conditions import ConditionConfig
from artigen.runtime.journal import read_lines
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.render import build_scene, render
from artigen.splats.render import rasterize
from artigen.train.appearance.drawn import roughen
from artigen.train.appearance.flow import measure_slats, train_appearance_flow
from artigen.train.appearance.vae import (
    HIDDEN,
    AppearanceLossConfig,
    appearance_losses,
    encode_appearance,
    hide_views,
    measure_features,
    train_appearance_vae,
)
from artigen.train.loop import LoopConfig
from artigen.types import Asset, VoxelGrid
from artigen.voxels.surface import HEIGHT_REACH

TRUNK = SlatVaeConfig(resolution=16, in_channels=16, model_channels=16, num_blocks=2, num_heads=2)
DECODER = GaussianDecoderConfig(
    trunk=TRUNK, gaussians=GaussianConfig(count=2, scale_bias=0.02, opacity_bias=0.5)
)


@pytest.fixture(scope="module")
def chest() -> tuple[Asset, AppearanceExample]:
    return make_example(make_chest())


def make_vae() -> AppearanceVae:
    torch.manual_seed(0)
    return AppearanceVae(TRUNK, DECODER)


def interior(asset: Asset) -> np.ndarray:
    """Voxels of the drawer's bottom, well inside of the chest."""
    assert asset.voxels is not None
    x, y, z = asset.voxels.centers().T
    drawer = [part.name for part in asset.parts].index("drawer")
    inner = (np.abs(x) < 0.2) & (np.abs(y) < 0.25) & (z < -0.3)
    return inner & (asset.voxels.part_ids == drawer)


def read_sides(example: AppearanceExample) -> np.ndarray:
    """Colour and height of both sides of every voxel."""
    first = example.features.shape[1] - SIDE_CHANNELS
    return example.features[:, first + 1 : -4].astype(float).reshape(-1, 2, 4)


def test_staggered_joints_visit_every_share_once_and_start_closed():
    fractions = plan_fractions(make_cabinet(), 8, staggered=True)
    door, inner, upper, lower = fractions[:, 1:].T
    for joint in (door, upper, lower):
        assert sorted(joint) == pytest.approx(np.linspace(0, 1, 8))
    assert (fractions[0] == 0).all()
    assert (door != upper)[1:].any()
    assert (upper != lower)[1:].any()
    assert (inner[door < 0.95] == 0).all()
    assert inner[door >= 0.95] == pytest.approx([1.0])


def test_joints_open_together_as_in_the_paper():
    fractions = plan_fractions(make_cabinet(), 5, staggered=False)
    assert np.array_equal(fractions[:, 3], np.linspace(0, 1, 5))
    assert np.array_equal(fractions[:, 3], fractions[:, 4])
    assert np.array_equal(fractions[:, 2], [0, 0, 0, 0, 1])


def test_both_coordinates_of_a_state_are_the_same_state():
    shape = make_chest()
    asset = shape_to_asset(shape, 16)
    fractions = plan_fractions(shape, 3, staggered=True)
    assert shape_coordinates(shape, asset, fractions)[2].tolist() == [0.0, 0.7]
    assert asset_coordinates(shape, asset, fractions)[2, 0] * asset.scale == pytest.approx(0.7)


def test_cameras_stand_all_around_and_more_of_them_in_front():
    directions = spread_directions(ViewConfig(count=200), 0.3)
    assert np.linalg.norm(directions, axis=1) == pytest.approx(np.ones(200))
    assert 0.7 < (directions[:, 0] < 0).mean() < 0.8
    assert directions[:, 2].min() > -0.46
    assert {tuple(row) for row in np.sign(directions[:, :2]).astype(int).tolist()} == {
        (-1, -1),
        (-1, 1),
        (1, -1),
        (1, 1),
    }


def test_features_of_one_colour_are_that_colour_where_a_voxel_was_seen(
    chest: tuple[Asset, AppearanceExample],
):
    example = chest[1]
    seen = example.views > 0
    assert 0.6 < seen.mean() < 1
    np.testing.assert_allclose(example.features[seen, :3], np.tile(COLOR, (seen.sum(), 1)), atol=0.01)
    assert not example.features[~seen].any()


def test_voxels_of_a_closed_drawer_are_seen_in_open_states_only(chest: tuple[Asset, AppearanceExample]):
    asset, opened = chest
    inner = interior(asset)
    assert inner.sum() > 10
    _, closed = make_example(make_chest(), states=1, kept=0)
    _, plain = make_example(make_chest(), states=1, kept=0, weighting="plain")
    assert not closed.views[inner].any()
    assert (opened.views[inner] > 0).mean() > 0.5
    assert (plain.views == 12).all()


def test_what_hides_a_voxel_does_not_colour_it():
    asset, seen = make_example(make_chest(inside="inside"), kept=0)
    _, plain = make_example(make_chest(inside="inside"), kept=0, weighting="plain")
    inner = interior(asset) & (seen.views > 0)
    wanted = np.array([0.1, 0.3, 0.8])
    off = [np.abs(one.features[inner, :3] - wanted).mean() for one in (seen, plain)]
    assert off[0] < 0.03
    assert off[1] > 0.1


def test_both_sides_of_a_board_have_their_own_colour_and_height():
    """The front of the drawer is of one colour, the rest of it of another; a cell is as thick as a board."""
    asset, example = make_example(make_chest(inside="inside"), sided=True, kept=0, views=24, size=48)
    assert asset.voxels is not None
    sides = read_sides(example)
    colors = COLOR_MIDDLE + COLOR_SPREAD * sides[..., :3]
    heights = HEIGHT_REACH * np.tanh(sides[..., 3])
    x, y, z = asset.voxels.coords.T
    lid = (z == 15) & (np.abs(y - 7.5) < 5) & (np.abs(x - 7.5) < 5)
    assert (example.facings[lid] == 5).all()
    np.testing.assert_allclose(colors[lid, 0], np.tile(COLOR, (lid.sum(), 1)), atol=0.02)
    np.testing.assert_allclose(heights[lid, 0], 0.5, atol=0.05)  # the grid ends with the lid
    inner = interior(asset)
    assert inner.sum() > 10
    assert (example.facings[inner] == 4).all()
    off = np.abs(colors[inner, 1] - INSIDE.color).max(axis=1)
    assert np.quantile(off, 0.8) < 0.02
    assert off.max() < 0.1  # pixels at its rim show some of what stands there


def test_a_voxel_that_no_view_shows_has_the_colour_that_it_is_painted_in():
    asset, example = make_example(make_chest(inside="inside"), sided=True, states=1, kept=0)
    hidden = (example.views == 0) & interior(asset)
    assert hidden.sum() > 10
    sides = read_sides(example)[hidden]
    shown = COLOR_MIDDLE + COLOR_SPREAD * sides[..., :3]
    off = np.abs(shown - INSIDE.color).max(axis=2)
    assert (off < 0.02).mean() > 0.8  # the others meet the front


def test_a_closed_run_is_not_told_what_it_hides():
    closed = close_curation(small_curation(states=3, views=6, kept=2))
    asset, example = make_example(make_chest(inside="inside"), sided=True, states=1, painted=closed.painted)
    hidden = (example.views == 0) & interior(asset)
    shown = COLOR_MIDDLE + COLOR_SPREAD * read_sides(example)[hidden][..., :3]
    assert hidden.sum() > 10
    assert np.abs(shown - INSIDE.color).max(axis=2).min() > 0.1


def test_the_less_a_side_was_seen_the_more_it_looks_as_others_that_are_painted_alike():
    """A row painted in one grey and seen half as bright; of the last three one is seen rarely, and wrongly,
    one never, and one neither seen nor painted."""
    count = FEW + 3
    cells = np.array([[3, y, 2] for y in range(count)])
    voxels = VoxelGrid(coords=cells, part_ids=np.zeros(count, dtype=int), resolution=16)
    mean = SideMean(voxels, np.zeros(count, dtype=int))
    well = list(range(FEW))
    for rows, grey in ((well, 0.4), (well, 0.4), ([FEW], 1.0)):
        ones = torch.ones(len(rows), 3)
        mean.add(
            SeenVoxels(
                rows=torch.tensor(rows),
                toward=torch.tensor([[-1.0 if rows == well else -0.5, 0.0, 0.0]]).repeat(len(rows), 1),
                color=grey * ones,
                clear=0.0 * ones[:, 0],
            )
        )
    known = np.ones((count, 2), dtype=int)
    known[-1] = 0
    paint = VoxelPaint(colors=np.full((count, 2, 3), 0.8), known=known, clear=np.zeros(count))
    looks = mean.finish(paint)
    trust = 0.25 / (0.25 + SURE)
    wanted = [0.4] * FEW + [trust * 1.0 + (1.0 - trust) * 0.4, 0.4, 0.4]
    torch.testing.assert_close(looks.colors[0, :, 0], torch.tensor(wanted))
    torch.testing.assert_close(looks.colors[1, :, 0], torch.full((count,), 0.4))


def test_what_is_painted_alike_is_seen_alike():
    painted = torch.tensor([[0.1] * 3] * 6 + [[0.8] * 3] * 6 + [[0.75] * 3]).repeat(2, 1, 1)
    seen = torch.tensor([[0.3] * 3] * 6 + [[0.7] * 3] * 6 + [[9.0] * 3]).repeat(2, 1, 1)
    sure = torch.tensor([True] * 12 + [False]).repeat(2, 1)
    found = see_alike(painted, seen, sure)
    torch.testing.assert_close(found[0, :, 0], torch.tensor([0.3] * 6 + [0.7] * 6 + [0.65]))
    assert torch.equal(see_alike(painted, seen, sure & False), painted)


def test_a_surface_alone_before_any_background_is_what_it_covers_and_what_it_lets_through():
    shape = make_chest(front="glass")
    asset, scene = shape_to_asset(shape, 16), build_scene([shape])
    cfg = ViewConfig(count=6, size=32, light=LIGHT, front=1.0)
    (state,) = photograph(scene, asset, np.zeros((1, len(shape.parts))), cfg)
    color, clear = look_at_surface(scene, state)
    pane = clear > 0
    assert 100 < pane.sum() < 0.9 * state.images.mask.sum()
    solid = state.images.mask & ~pane
    torch.testing.assert_close(color[solid], state.images.rgb[solid])
    bright = replace(LIGHT, background=(1.0, 1.0, 1.0), layers=1)
    seen = render(scene, state.cameras, [np.zeros(len(shape.parts))] * 6, cfg=bright).rgb
    alone = (1.0 - clear[..., None]) * color + clear[..., None]
    torch.testing.assert_close(alone[pane], seen[pane], atol=0.01, rtol=0)


@pytest.mark.parametrize(("through", "each"), [(0.25, 0.5), (0.11, 0.11**0.5), (0.09, 0.09)])
def test_voxels_that_share_a_pane_let_through_together_what_it_does(through: float, each: float):
    """What transmits less than a tenth is no pane."""
    cells = np.array([[x, y, 2] for x in (3, 4) for y in range(4)] + [[3, 6, 2]])
    voxels = VoxelGrid(coords=cells, part_ids=np.zeros(9, dtype=int), resolution=16)
    mean = SideMean(voxels, np.zeros(9, dtype=int))
    for way in (-1.0, 1.0):
        seen = SeenVoxels(
            rows=torch.arange(9),
            toward=torch.tensor([[way, 0.0, 0.0]]).repeat(9, 1),
            color=torch.rand(9, 3),
            clear=torch.tensor([through] * 8 + [0.64]),
        )
        mean.add(seen)
    paint = VoxelPaint(colors=np.zeros((9, 2, 3)), known=np.zeros((9, 2), dtype=int), clear=np.zeros(9))
    np.testing.assert_allclose(mean.finish(paint).clear, [each] * 8 + [0.64], atol=1e-6)


def test_glass_is_known_by_what_is_seen_through_it():
    asset, example = make_example(make_chest(front="glass"), sided=True, kept=0)
    assert asset.voxels is not None
    clear = example.features[:, 16].astype(float)
    pane = asset.voxels.coords[:, 0] == 0
    pane &= (np.abs(asset.voxels.coords[:, 1:] - 7.5) < 4).all(axis=1)
    seen = example.views > 0
    assert pane.sum() > 20
    assert np.median(clear[pane & seen]) > 0.5  # the rest is what it mirrors
    assert (clear[~pane & (asset.voxels.part_ids == 0)] == 0).all()


def test_what_lies_behind_another_part_is_not_seen_through_it():
    """A cell of the body behind the closed drawer's front is as near to it as its own surface."""
    asset, example = make_example(make_chest(front="inside"), states=1, kept=0)
    assert asset.voxels is not None
    seen = (example.views > 0) & (example.part_ids == 0)
    blue = example.features[seen, 2].astype(float) > example.features[seen, 0].astype(float)
    assert blue.mean() < 0.02


def test_nothing_is_newly_exposed_while_closed_and_only_hidden_surface_when_open():
    shape = make_chest(inside="inside")
    asset = shape_to_asset(shape, 16)
    cfg = ViewConfig(count=8, size=32, light=LIGHT)
    pictures = take_pictures(shape, asset, plan_fractions(shape, 2, staggered=False), cfg)
    closed, opened = pictures.state == 0, pictures.state == 1
    assert not pictures.exposed[closed].any()
    assert pictures.exposed[opened].any()
    blue = pictures.rgb[..., 2].astype(int) > pictures.rgb[..., 0].astype(int) + 50
    inside = blue[opened] & pictures.mask[opened]
    assert inside.sum() > 100
    assert pictures.exposed[opened][inside].mean() > 0.98
    behind = pictures.position[:, 0] > 1.0
    assert (opened & behind).any()
    assert not pictures.exposed[opened & behind].any()


def test_the_test_of_exposure_finds_the_closed_object_visible_everywhere():
    shape = make_chest()
    scene, qpos = build_scene([shape]), np.zeros(2)
    cameras = place_cameras(shape, qpos, ViewConfig(count=6, size=32), 0.0)
    images = render(scene, cameras, [qpos] * 6, cfg=LIGHT)
    hidden = find_exposed(scene, cameras, images, qpos)
    assert images.mask.sum() > 500
    assert hidden.sum() < 0.01 * images.mask.sum()  # into the gaps around the drawer, none of the directions


def test_one_looks_through_glass():
    fractions = np.array([[0.0, 1.0]])
    cfg = ViewConfig(count=4, size=32, light=LIGHT, front=1.0)
    shares = []
    for front in ("plain", "glass"):
        shape = make_chest(inside="inside", front=front)
        pictures = take_pictures(shape, shape_to_asset(shape, 16), fractions, cfg)
        shares.append(pictures.exposed.mean())
    assert shares[1] < 0.5 * shares[0]


def test_a_closed_run_has_as_many_pictures():
    closed = close_curation(small_curation(states=3, views=6, kept=2))
    assert (closed.states, closed.views.count, closed.kept) == (1, 18, 6)
    _, example = make_example(make_chest(), states=1, views=6, kept=6)
    assert set(example.pictures.state.tolist()) == {0}
    assert {tuple(row) for row in example.pictures.background.tolist()} == {(0, 0, 0), (255, 255, 255)}


def test_shards_give_back_what_was_written(tmp_path: Path, chest: tuple[Asset, AppearanceExample]):
    example = replace(chest[1], image=np.zeros((8, 8, 4), dtype=np.uint8))
    path = tmp_path / "shard.npz"
    write_appearance_shard(path, [example, replace(example, name="again")])
    first, second = read_appearance_shard(path)
    assert (first.name, second.name, second.resolution) == (example.name, "again", 16)
    for one in (first, second):
        for name in (*PER_VOXEL, *PER_OBJECT, "table", "image"):
            assert np.array_equal(getattr(one, name), getattr(example, name))
        for name, value in vars(example.pictures).items():
            assert np.array_equal(getattr(one.pictures, name), value)
    assert [file.name for file in tmp_path.iterdir()] == ["shard.npz"]


def losses_of(vae: AppearanceVae, batch: PictureBatch) -> tuple[Encoded, torch.Tensor]:
    encoded = vae(batch.coords, batch.feats, torch.zeros(len(batch.coords), 8))
    return encoded, draw_pictures(encoded.splats, batch, raster_config(vae, torch.device("cpu")))


@torch.no_grad()
def test_at_rest_the_articulated_loss_is_the_plain_one(chest: tuple[Asset, AppearanceExample]):
    vae, example = make_vae(), chest[1]
    batch = picture_batch([example, example], [np.array([0, 1]), np.array([2, 3])])
    assert not (example.pictures.state[:4]).any()
    encoded, drawn = losses_of(vae, batch)
    half = len(encoded.splats.means) // 2
    plain = rasterize(
        type(encoded.splats)(**{name: value[:half] for name, value in vars(encoded.splats).items()}),
        example.pictures.cameras(np.array([0, 1])),
        background=batch.background[0],
        cfg=raster_config(vae, torch.device("cpu")),
    ).color
    torch.testing.assert_close(drawn[0], plain, atol=1e-5, rtol=0)
    one = appearance_losses(encoded, drawn, batch, AppearanceLossConfig())
    two = appearance_losses(encoded, torch.stack([plain, drawn[1]]), batch, AppearanceLossConfig())
    for name, value in one.items():
        torch.testing.assert_close(value, two[name])


@torch.no_grad()
def test_open_pictures_show_moved_gaussians(chest: tuple[Asset, AppearanceExample]):
    vae, example = make_vae(), chest[1]
    opened = int(np.flatnonzero(example.pictures.state == 1)[0])
    batch = picture_batch([example], [np.array([opened])])
    still = replace(batch, displacements=(np.tile(np.eye(4), (1, 2, 1, 1)),))
    assert (losses_of(vae, batch)[1] - losses_of(vae, still)[1]).abs().max() > 0.1


def test_terms_have_their_weights(chest: tuple[Asset, AppearanceExample]):
    vae, example = make_vae(), chest[1]
    batch = picture_batch([example], [np.array([0, 5])])
    encoded, drawn = losses_of(vae, batch)
    terms = appearance_losses(encoded, drawn, batch, AppearanceLossConfig(l1=2.0))
    assert terms["l1"].item() == pytest.approx(2 * (drawn - batch.rgb).abs().mean().item())
    assert terms["volume"].item() == pytest.approx(1e4 * (0.02**2 + 9e-4**2) ** 1.5, rel=1e-3)
    assert terms["opacity"].item() == pytest.approx(1e-3 * 0.25, rel=1e-3)
    terms["l1"].backward()
    assert vae.decoder.out_layer.weight.grad is not None
    assert vae.decoder.out_layer.weight.grad.abs().max() > 0


def test_batches_follow_from_their_number_and_epochs_hold_every_object(
    chest: tuple[Asset, AppearanceExample],
):
    examples = [replace(chest[1], name=str(number)) for number in range(3)]
    shifted = [
        replace(one, features=np.full_like(one.features, number)) for number, one in enumerate(examples)
    ]
    first = list(itertools.islice(draw_picture_batches(shifted, 1, 2, seed=4), 6))
    later = list(itertools.islice(draw_picture_batches(shifted, 1, 2, seed=4, start=2), 4))
    for one, two in zip(first[2:], later, strict=True):
        assert torch.equal(one.rgb, two.rgb)
        assert torch.equal(one.feats, two.feats)
    for epoch in (first[:3], first[3:]):
        assert sorted(float(batch.feats[0, 0]) for batch in epoch) == [0.0, 1.0, 2.0]


def fit(example: AppearanceExample, folder: Path) -> AppearanceVae:
    """Six steps."""
    vae = make_vae()
    cfg = LoopConfig(steps=6, learning_rate=1e-2, warmup=1, ema=0.0, report_every=1, checkpoint_minutes=0.0)
    train_appearance_vae(vae, [example], folder, cfg, batch=1, pictures=2, losses=AppearanceLossConfig())
    return vae


@pytest.mark.slow
def test_training_lowers_the_loss_and_goes_on_as_if_never_stopped(
    tmp_path: Path, chest: tuple[Asset, AppearanceExample], monkeypatch: pytest.MonkeyPatch
):
    def stop(bar: object, name: str, line: dict[str, float]) -> None:
        if line["step"] == 4:
            raise KeyboardInterrupt

    whole = fit(chest[1], tmp_path / "whole")
    with torch.no_grad():
        batch = picture_batch([chest[1]], [np.array([0, 1, 4, 5])])
        off = [float((losses_of(vae, batch)[1] - batch.rgb).abs().mean()) for vae in (make_vae(), whole)]
    assert off[1] < 0.8 * off[0]
    with monkeypatch.context() as patched:
        patched.setattr(artigen.train.loop, "show_metrics", stop)
        with pytest.raises(KeyboardInterrupt):
            fit(chest[1], tmp_path / "parts")
    resumed = fit(chest[1], tmp_path / "parts")
    for name, value in whole.state_dict().items():
        torch.testing.assert_close(resumed.state_dict()[name], value, msg=name)


def test_networks_in_half_precision_feed_pictures_in_full(
    tmp_path: Path, chest: tuple[Asset, AppearanceExample], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(artigen.train.loop, "autocast_type", lambda device: torch.bfloat16)
    vae, kinds = make_vae(), []
    vae.register_forward_hook(lambda network, given, made: kinds.append(made.splats.means.dtype))
    train_appearance_vae(
        vae,
        [chest[1]],
        tmp_path,
        LoopConfig(steps=1, report_every=1),
        batch=1,
        pictures=1,
        losses=AppearanceLossConfig(),
    )
    assert kinds == [torch.float32]
    assert np.isfinite(read_lines(tmp_path / "metrics.jsonl")[0]["loss"])


def test_what_views_show_is_hidden_beyond_a_plane_as_often_as_said():
    generator = torch.Generator().manual_seed(0)
    coords = torch.tensor([[0, x, 3, 3] for x in range(30)])
    feats = torch.ones(30, 5)
    ends = []
    for _ in range(400):
        told = hide_views(coords, feats, generator, kept=2)
        assert (told[:, 3:] == 1).all()
        hidden = (told[:, :3] == 0).all(dim=1)
        assert torch.equal(hidden, (told[:, :3] == 0).any(dim=1))
        assert int((hidden[1:] != hidden[:-1]).sum()) <= 1
        ends.append((bool(hidden.any()), float(hidden.float().mean())))
    often = np.mean([some for some, _ in ends])
    assert 0.85 * HIDDEN < often < 1.1 * HIDDEN  # planes may pass by
    assert np.mean([share for some, share in ends if some]) == pytest.approx(0.5, abs=0.1)


def test_features_are_normalised_over_voxels_that_were_seen(chest: tuple[Asset, AppearanceExample]):
    views = np.array([1, 0, 3, 2], dtype=np.uint16)
    features = np.array([[1.0, 5.0], [90.0, 90.0], [3.0, 5.0], [5.0, 5.0]], dtype=np.float16)
    center, spread = measure_features([replace(chest[1], features=features, views=views)])
    torch.testing.assert_close(center, torch.tensor([3.0, 5.0]))
    torch.testing.assert_close(spread, torch.tensor([(8.0 / 3.0) ** 0.5, 1e-2]))


def test_the_spread_of_latents_is_that_of_draws_from_them():
    found = measure_slats([torch.zeros(500, 3), torch.ones(500, 3)], [torch.full((500, 3), 0.5)] * 2)
    torch.testing.assert_close(found.mean, torch.full((3,), 0.5))
    torch.testing.assert_close(found.std, torch.full((3,), 0.5**0.5), atol=1e-3, rtol=0)
    assert not found.expected.any()


def test_what_is_told_of_voxels_leaves_only_the_rest_to_be_drawn(chest: tuple[Asset, AppearanceExample]):
    told = chest[1].attributes()
    rng = np.random.default_rng(0)
    paints = rng.random((8, PAINT), dtype=np.float32)
    known = [np.concatenate([told[:, :-PAINT], np.tile(row, (len(told), 1))], axis=1) for row in paints]
    slope = rng.normal(size=(PAINT, 5))
    means = [
        torch.from_numpy(one[:, -PAINT:] @ slope + 0.7 + 0.2 * rng.normal(size=(len(one), 5)))
        for one in known
    ]
    found = measure_slats(means, [torch.zeros_like(one) for one in means], known)
    torch.testing.assert_close(found.std, torch.full((5,), 0.2), atol=0.02, rtol=0)
    torch.testing.assert_close(found.mean.double(), torch.cat(means).mean(dim=0), atol=1e-5, rtol=0)


def test_the_flow_is_trained_on_normalised_latents_of_all_voxels(
    tmp_path: Path, chest: tuple[Asset, AppearanceExample]
):
    examples = [chest[1], chest[1]]
    means, stds = encode_appearance(make_vae(), examples)
    assert [len(one) for one in means] == [len(chest[1].coords)] * 2
    means = [3.0 + one for one in means]
    conditions = ConditionConfig(width=32, image_size=0)
    torch.manual_seed(0)
    flow = SlatFlow(SlatPatchDitConfig(resolution=16, stem=8, width=32, blocks=1, heads=2), conditions)
    before = flow.network.get_parameter("out_layer.weight").detach().clone()
    voxels, facings = chest[0].voxels, chest[1].facings.astype(int)
    assert voxels is not None
    train_appearance_flow(
        flow,
        (means, stds),
        examples,
        tmp_path,
        LoopConfig(steps=3, learning_rate=3e-3, warmup=1, report_every=1),
        batch=2,
        conditions=conditions,
        drawn=[roughen(voxels, facings, np.random.default_rng(seed)) for seed in range(2)],
    )
    lines = [line["velocity"] for line in read_lines(tmp_path / "metrics.jsonl")]
    assert len(lines) == 3
    assert np.isfinite(lines).all()
    assert (flow.network.get_parameter("out_layer.weight") != before).any()
    told = np.concatenate([one.attributes() for one in examples])
    normal = flow.normalise(torch.cat(means).float(), torch.from_numpy(told))
    torch.testing.assert_close(normal.mean(dim=0), torch.zeros(8), atol=1e-2, rtol=0)
    drawn = normal.var(dim=0) + ((torch.cat(stds).float() / flow.latent_std) ** 2).mean(dim=0)
    torch.testing.assert_close(drawn, torch.ones(8), atol=1e-2, rtol=0)
