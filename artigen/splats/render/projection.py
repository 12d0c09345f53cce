"""Projects splats: elliptical weighted averaging with the filter of Mip-Splatting.

A splat with covariance ``S`` at ``(x, y, z)`` before the camera leaves a Gaussian of covariance
``J W S W^T J^T + k I`` in the picture, where ``W`` turns into the camera and ``J`` is the derivative of
the projection (Zwicker et al., EWA Splatting, 2001). The filter ``k I`` makes it wider; its opacity falls
by ``sqrt(det / det_filtered)``, so that it covers as much as before (Yu et al., Mip-Splatting, 2024).
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.shapes.render.cameras import Cameras, camera_axes, pixel_sizes
from artigen.splats.render.config import RasterConfig
from artigen.splats.render.splats import Splats

WIDEST = 1.3
"""Beyond this multiple of the picture's half width the derivative of the projection is that at its edge."""


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """One pinhole camera."""

    axes: Float[Tensor, "3 3"]
    """Rows are the picture's right, down and forward directions in the world."""
    position: Float[Tensor, "3"]
    focal: Float[Tensor, ""]
    """Pixels per unit at depth one; the axis goes through the middle of the picture."""
    width: int
    height: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Footprints:
    """Projected splats of a camera: ``alpha = exp(f - (a dx^2 + 2 b dx dy + c dy^2) / 2)``."""

    ellipses: Float[Tensor, "V 6"]
    """Column and row of the centre (pixels), a, b, c (per square pixel), f."""
    reach: Float[Tensor, "V 2"]
    """Columns and rows from the centre to where alpha has fallen to ``min_alpha``."""
    depths: Float[Tensor, "V"]
    rows: Int[Tensor, "V"]
    """Which splats these are."""


def list_views(cameras: Cameras, splats: Splats) -> list[View]:
    """The cameras of a batch, in the splats' dtype and on their device."""
    kind = {"dtype": splats.means.dtype, "device": splats.means.device}
    axes = camera_axes(cameras).to(**kind)
    position = cameras.position.to(**kind)
    focal = (1.0 / pixel_sizes(cameras)).to(**kind)
    return [
        View(axes=axes[k], position=position[k], focal=focal[k], width=cameras.width, height=cameras.height)
        for k in range(len(focal))
    ]


def project(splats: Splats, view: View, cfg: RasterConfig) -> Footprints:
    """Footprints of the splats before the camera that reach ``min_alpha``, wherever they lie."""
    local = (splats.means - view.position) @ view.axes.T
    rows = (local[:, 2].detach() > cfg.near).nonzero()[:, 0]
    x, y, z = local.index_select(0, rows).unbind(1)
    right, down, ahead = (view.axes @ _stretched_axes(splats, rows)).unbind(1)  # V 3 each
    wide, high = (WIDEST * size / (2.0 * view.focal) for size in (view.width, view.height))
    pixels = (view.focal / z)[:, None]
    across = pixels * (right - torch.clamp(x / z, -wide, wide)[:, None] * ahead)
    along = pixels * (down - torch.clamp(y / z, -high, high)[:, None] * ahead)
    # Determinants as sums of squares keep their digits where those of covariances cancel.
    xx, xy, yy = (across * across).sum(1), (across * along).sum(1), (along * along).sum(1)
    area = torch.linalg.vector_norm(torch.linalg.cross(across, along), dim=1)
    k = cfg.filter_variance
    filtered = area**2 + k * (xx + yy) + k * k
    strength = splats.opacities.index_select(0, rows) * area * filtered.rsqrt()
    seen = (strength.detach() > cfg.min_alpha).nonzero()[:, 0]
    columns = (
        view.focal * x / z + view.width / 2.0,
        view.focal * y / z + view.height / 2.0,
        (yy + k) / filtered,
        -xy / filtered,
        (xx + k) / filtered,
    )
    ellipses = torch.stack([column.index_select(0, seen) for column in columns], dim=1)
    height = torch.log(strength.index_select(0, seen))
    spread = torch.stack([xx, yy], dim=1).detach().index_select(0, seen) + k
    fall = 2.0 * (height.detach() - torch.log(torch.tensor(cfg.min_alpha, dtype=z.dtype, device=z.device)))
    return Footprints(
        ellipses=torch.cat([ellipses, height[:, None]], dim=1),
        reach=torch.sqrt(fall[:, None] * spread),
        depths=z.index_select(0, seen),
        rows=rows.index_select(0, seen),
    )


def _stretched_axes(splats: Splats, rows: Int[Tensor, "V"]) -> Float[Tensor, "V 3 3"]:
    """Columns are the axes of the splats, as long as their standard deviations."""
    quats = torch.nn.functional.normalize(splats.quats.index_select(0, rows), dim=1)
    w, x, y, z = quats.unbind(1)
    entries = [
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    ]  # fmt: skip
    return torch.stack(entries, dim=1).reshape(-1, 3, 3) * splats.scales.index_select(0, rows)[:, None, :]
