"""The gsplat package (CUDA) behind the interface of our rasteriser; imported on demand."""

import torch
from jaxtyping import Float
from torch import Tensor

from artigen.splats.render.config import RasterConfig
from artigen.splats.render.projection import View
from artigen.splats.render.splats import Rendering, Splats


def rasterize_gsplat(
    splats: Splats, views: list[View], background: Float[Tensor, "B C"], cfg: RasterConfig
) -> Rendering:
    """Pictures by gsplat 1.5's ``rasterization`` in its antialiased mode.

    It has fixed cut-offs: ``min_alpha`` 1 / 255, ``max_alpha`` 0.999, and it stops each pixel at a
    transmittance of 1e-4; otherwise pictures are the same.

    Raises:
        ModuleNotFoundError: If gsplat is not installed.
    """
    try:
        from gsplat import rasterization  # pyright: ignore[reportMissingImports]
    except ModuleNotFoundError as err:
        raise ModuleNotFoundError(
            "the gsplat backend needs the package gsplat and a CUDA device: pip install gsplat, "
            'or take RasterConfig(backend="torch")'
        ) from err
    first = views[0]
    drawn, alpha, _ = rasterization(
        means=splats.means,
        quats=splats.quats,
        scales=splats.scales,
        opacities=splats.opacities,
        colors=splats.colors,
        viewmats=torch.stack([_matrix_of(view) for view in views]),
        Ks=torch.stack([_intrinsics_of(view) for view in views]),
        width=first.width,
        height=first.height,
        near_plane=cfg.near,
        eps2d=cfg.filter_variance,
        render_mode="RGB+ED",
        rasterize_mode="antialiased",
    )
    alpha = alpha[..., 0]
    return Rendering(
        color=drawn[..., :-1] + (1.0 - alpha)[..., None] * background[:, None, None],
        alpha=alpha,
        depth=torch.where(alpha > 0, drawn[..., -1], torch.inf),
    )


def _matrix_of(view: View) -> Float[Tensor, "4 4"]:
    """World to camera: x right, y down, z forward."""
    moved = -(view.axes @ view.position)
    last = torch.tensor([[0.0, 0.0, 0.0, 1.0]], dtype=moved.dtype, device=moved.device)
    return torch.cat([torch.cat([view.axes, moved[:, None]], dim=1), last])


def _intrinsics_of(view: View) -> Float[Tensor, "3 3"]:
    zero, one = torch.zeros_like(view.focal), torch.ones_like(view.focal)
    rows = [
        view.focal, zero, one * view.width / 2.0,
        zero, view.focal, one * view.height / 2.0,
        zero, zero, one,
    ]  # fmt: skip
    return torch.stack(rows).reshape(3, 3)
