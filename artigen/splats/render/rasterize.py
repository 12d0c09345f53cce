"""`rasterize`: pictures of splats, differentiable in all splat parameters."""

from collections.abc import Sequence

import torch
from jaxtyping import Float
from torch import Tensor

from artigen.shapes.render.cameras import Cameras
from artigen.splats.render.blending import blend
from artigen.splats.render.config import RasterConfig
from artigen.splats.render.projection import View, list_views, project
from artigen.splats.render.splats import Rendering, Splats
from artigen.splats.render.tiles import Grid


def rasterize(
    splats: Splats,
    cameras: Cameras,
    *,
    background: Float[Tensor, "*B C"] | Sequence[float] | None = None,
    cfg: RasterConfig | None = None,
) -> Rendering:
    """Renders one set of splats, one camera after the other.

    Args:
        background: Colour behind the splats, one for all pictures or one each; black when None.

    Raises:
        ValueError: If the background does not have the channels of the splats, or there is no camera.
    """
    cfg = cfg or RasterConfig()
    count, channels = len(cameras.fov), splats.colors.shape[1]
    if count == 0:
        raise ValueError("rasteriser: no cameras, expected at least 1")
    behind = splats.colors.new_zeros(channels) if background is None else background
    behind = torch.as_tensor(behind, dtype=splats.colors.dtype, device=splats.colors.device)
    if behind.shape not in ((channels,), (count, channels)):
        raise ValueError(
            f"rasteriser: background has shape {tuple(behind.shape)}, "
            f"expected ({channels},) or ({count}, {channels})"
        )
    behind = behind.expand(count, channels)
    with torch.autocast(splats.means.device.type, enabled=False):
        sums = torch.stack([rasterize_view(splats, view, cfg) for view in list_views(cameras, splats)])
    return _compose(sums, behind)


def rasterize_view(splats: Splats, view: View, cfg: RasterConfig) -> Float[Tensor, "H W F"]:
    """Sums over the splats that a camera sees, without background: colours, depth, coverage."""
    seen = project(splats, view, cfg)
    order = torch.argsort(seen.depths.detach(), stable=True)
    depths = seen.depths.index_select(0, order)[:, None]
    colors = splats.colors.index_select(0, seen.rows.index_select(0, order))
    return blend(
        seen.ellipses.index_select(0, order),
        torch.cat([colors, depths, torch.ones_like(depths)], dim=1),
        seen.reach.index_select(0, order),
        Grid(width=view.width, height=view.height, tile=cfg.tile),
        cfg,
    )


def _compose(sums: Float[Tensor, "B H W F"], background: Float[Tensor, "B C"]) -> Rendering:
    color, depth, alpha = sums[..., :-2], sums[..., -2], sums[..., -1]
    covered = alpha > 0
    mean = depth / torch.where(covered, alpha, 1.0)
    return Rendering(
        color=color + (1.0 - alpha)[..., None] * background[:, None, None],
        alpha=alpha,
        depth=torch.where(covered, mean, torch.inf),
    )
