"""Renders a procedural object in its joint states, as plain values."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import torch
from jaxtyping import Bool, Float, Int, UInt8
from torch import Tensor

from artigen.appearance.exposure import find_exposed
from artigen.appearance.states import asset_coordinates, shape_coordinates
from artigen.appearance.views import ViewConfig, pick_cameras, place_cameras, scale_cameras
from artigen.kinematics import displacements
from artigen.shapes.asset import frame_shape, part_owners
from artigen.shapes.render import Cameras, Images, RenderConfig, Scene, build_scene, render
from artigen.shapes.shape import Shape
from artigen.types import Asset

BACKGROUNDS = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
"""Backgrounds of even and odd views; transparency must hold before both."""
OPAQUE = 0.05
"""Lower bound on the opacity by which a surface's own colour is recovered."""
PIXELS = 1 << 20
"""Rays cast at once."""
NOTHING = 255
"""Part number of a pixel that shows the background."""
TURN = 0.7548776662466927
"""Shift of the camera sequence from one state to the next (`artigen.appearance.views.spread_directions`)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Pictures:
    """Pictures of one object, cameras in unit lengths; ``displacements`` are those of the parts, by state."""

    rgb: UInt8[np.ndarray, "V H W 3"]
    background: UInt8[np.ndarray, "V 3"]
    parts: UInt8[np.ndarray, "V H W"]
    """Part of the asset that each pixel shows, `NOTHING` where it shows none."""
    exposed: Bool[np.ndarray, "V H W"]
    """Pixels whose surface is hidden from everywhere while the object is closed."""
    state: UInt8[np.ndarray, "V"]
    displacements: Float[np.ndarray, "S P 4 4"]
    position: Float[np.ndarray, "V 3"]
    target: Float[np.ndarray, "V 3"]
    fov: Float[np.ndarray, "V"]

    @property
    def mask(self) -> Bool[np.ndarray, "V H W"]:
        """Pixels that show the object."""
        return self.parts != NOTHING

    def cameras(self, chosen: Int[np.ndarray, "K"]) -> Cameras:
        """The cameras of some pictures."""
        return Cameras(
            position=torch.from_numpy(self.position[chosen]),
            target=torch.from_numpy(self.target[chosen]),
            fov=torch.from_numpy(self.fov[chosen]),
            width=self.rgb.shape[2],
            height=self.rgb.shape[1],
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """Pictures of one joint state, in metres."""

    qpos: Float[np.ndarray, "P"]
    displacements: Float[np.ndarray, "P 4 4"]
    """Displacements of the asset's parts (unit lengths)."""
    owners: Int[np.ndarray, "Q"]
    """Part of the asset that each part of the shape belongs to."""
    cameras: Cameras
    images: Images
    behind: Int[Tensor, "V"]
    """Index into `BACKGROUNDS` of each picture."""
    light: RenderConfig
    """Render settings of the pictures that are kept."""


def take_pictures(
    shape: Shape, asset: Asset, fractions: Float[np.ndarray, "S P"], cfg: ViewConfig
) -> Pictures:
    """All pictures of given states, without features; they are the references of evaluations.

    Args:
        fractions: Share of its range that each part of the shape is open by, state by state.
    """
    scene = build_scene([shape])
    center, scale = frame_shape(shape)
    rows = np.arange(cfg.count)
    return join_pictures(
        [
            keep_pictures(scene, state, number, scale_cameras(state.cameras, center, scale), rows)
            for number, state in enumerate(photograph(scene, asset, fractions, cfg))
        ]
    )


def join_pictures(states: list[Pictures]) -> Pictures:
    """Pictures of several states, one state after another."""
    return Pictures(
        **{name: np.concatenate([getattr(one, name) for one in states]) for name in vars(states[0])}
    )


def premultiply(images: Images) -> Float[Tensor, "V 4 H W"]:
    """Colour and coverage, black where a pixel shows the background."""
    alpha = images.mask[..., None].float()
    return torch.cat([images.rgb * alpha, alpha], dim=3).permute(0, 3, 1, 2)


def shown_parts(state: State) -> UInt8[np.ndarray, "V H W"]:
    """Part of the asset that each pixel shows, `NOTHING` where it shows none."""
    images = state.images
    return np.where(images.mask, state.owners[images.part_ids], NOTHING).astype(np.uint8)


def look_at_surface(scene: Scene, state: State) -> tuple[Float[Tensor, "V H W 3"], Float[Tensor, "V H W"]]:
    """Renders the nearest surface alone, without what is visible through it.

    Returns:
        Its own colour, and its transmission.
    """
    images = state.images
    if bool((scene.paint.opacity >= 1).all()):
        return images.rgb, torch.zeros_like(images.depth)
    light = replace(state.light, supersampling=1, layers=1)
    dark, bright = (
        _render_before(scene, state.cameras, state.qpos, torch.full_like(state.behind, number), light).rgb
        for number in range(len(BACKGROUNDS))
    )
    clear = (bright - dark).mean(dim=3) * images.mask
    return (dark / (1.0 - clear[..., None]).clamp(min=OPAQUE)).clamp(max=1.0), clear


def photograph(
    scene: Scene, asset: Asset, fractions: Float[np.ndarray, "S P"], cfg: ViewConfig
) -> Iterator[State]:
    """Renders the one shape of a scene, state by state.

    Args:
        fractions: Share of its range that each part of the shape is open by, state by state.
    """
    shape = scene.shapes[0]
    owners = part_owners(shape, asset)
    in_metres = shape_coordinates(shape, asset, fractions)
    moved = displacements(asset, asset_coordinates(shape, asset, fractions))
    for number, qpos in enumerate(in_metres):
        cameras = place_cameras(shape, qpos, cfg, (number * TURN) % 1.0)
        behind = torch.arange(cfg.count) % len(BACKGROUNDS)
        yield State(
            qpos=qpos,
            displacements=moved[number],
            owners=owners,
            cameras=cameras,
            images=_render_before(scene, cameras, qpos, behind, cfg.light),
            behind=behind,
            light=replace(cfg.light, supersampling=cfg.sharpness),
        )


def keep_pictures(
    scene: Scene, state: State, number: int, cameras: Cameras, rows: Int[np.ndarray, "K"]
) -> Pictures:
    """The pictures ``rows`` of a state as plain values; ``cameras`` are the state's, in unit lengths."""
    chosen = torch.from_numpy(rows)
    behind, apart = state.behind[chosen], pick_cameras(state.cameras, chosen)
    images = Images(**{name: value[chosen] for name, value in vars(state.images).items()})
    if state.light.supersampling > 1 and len(rows):
        images = _render_before(scene, apart, state.qpos, behind, state.light)
    exposed = torch.zeros_like(images.mask)
    if state.qpos.any() and len(rows):
        exposed = find_exposed(scene, apart, images, state.qpos)
    return Pictures(
        rgb=_bytes(images.rgb),
        background=_bytes(torch.tensor(BACKGROUNDS)[behind]),
        parts=shown_parts(replace(state, images=images)),
        exposed=exposed.numpy(),
        state=np.full(len(rows), number, dtype=np.uint8),
        displacements=state.displacements[None],
        position=cameras.position[chosen].numpy(),
        target=cameras.target[chosen].numpy(),
        fov=cameras.fov[chosen].double().numpy(),
    )


def _render_before(
    scene: Scene,
    cameras: Cameras,
    qpos: Float[np.ndarray, "P"],
    behind: Int[Tensor, "V"],
    light: RenderConfig,
) -> Images:
    """Renders one joint state, each picture with its background, in the order of the cameras."""
    at_once = max(1, PIXELS // (cameras.width * cameras.height * light.supersampling**2))
    rows = [
        (some, color)
        for number, color in enumerate(BACKGROUNDS)
        for some in (behind == number).nonzero()[:, 0].split(at_once)
        if len(some)
    ]
    parts = [
        render(scene, pick_cameras(cameras, some), [qpos] * len(some), cfg=replace(light, background=color))
        for some, color in rows
    ]
    order = torch.cat([some for some, _ in rows]).argsort()
    return Images(
        **{name: torch.cat([getattr(part, name) for part in parts])[order] for name in vars(parts[0])}
    )


def _bytes(values: Tensor) -> np.ndarray:
    return torch.round(255.0 * values.clamp(0.0, 1.0)).to(torch.uint8).numpy()
