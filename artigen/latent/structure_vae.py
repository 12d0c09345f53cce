"""The structure VAE {E, D} for training and generation: patches in, occupancy and attributes out.

Two networks behind one interface: the compact one (`artigen.latent.patch_vae`), and the paper's
convolutions over the dense field (`artigen.latent.conv_vae`, section 4.1).
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from artigen.latent.conv_vae import ConvDecoder, ConvEncoder, ConvVaeConfig
from artigen.latent.outline import OutlineBatch, draw_hint, find_candidates, reach_cells
from artigen.latent.patch_vae import NEVER, PatchDecoder, PatchEncoder, PatchVaeConfig
from artigen.latent.patches import PATCH, PatchBatch, as_patches, fold, from_patches, unfold, unravel
from artigen.latent.smoothing import steady_occupancy
from artigen.latent.volumes import sample_gaussian
from artigen.types import FULL_TURN
from artigen.voxels.fields import ROW, VoxelFields


@dataclass(frozen=True, kw_only=True, eq=False)
class Reconstruction:
    """Result of a pass through the VAE: logits of all cells, channels of the occupied patches, posterior."""

    logits: Float[Tensor, "N K"]
    attributes: Float[Tensor, "P K C"]
    mean: Float[Tensor, "B D X Y Z"]
    logvar: Float[Tensor, "B D X Y Z"]


class StructureVae(nn.Module):
    """Articulated voxel fields to latents and back."""

    def __init__(self, cfg: PatchVaeConfig | ConvVaeConfig) -> None:
        super().__init__()
        self.latent_channels = cfg.latent_channels
        patched = isinstance(cfg, PatchVaeConfig)
        self.encoder = PatchEncoder(cfg) if patched else ConvEncoder(cfg)
        self.decoder = PatchDecoder(cfg) if patched else ConvDecoder(cfg)

    def encode(self, patches: PatchBatch) -> tuple[Float[Tensor, "B D X Y Z"], Float[Tensor, "B D X Y Z"]]:
        """Mean and log-variance of the latents."""
        if isinstance(self.encoder, PatchEncoder):
            return self.encoder(patches)
        mean, logvar = self.encoder(unfold(patches))
        return mean.float(), logvar.float()

    def decode(
        self,
        z: Float[Tensor, "B D X Y Z"],
        index: Int[Tensor, "P"] | None = None,
        outlines: OutlineBatch | None = None,
        *,
        steady: bool = False,
    ) -> tuple[Float[Tensor, "N K"], Float[Tensor, "P K C"], Int[Tensor, "P"]]:
        """Occupancy logits of every cell, and the channels of the patches ``index``.

        Without ``index``, the patches are those decoded with an occupied cell; the index is returned. With
        ``steady``, occupancy is smoothed along lines first, if the network decodes under outlines.

        Raises:
            ValueError: If the network decodes under outlines and there are none.
        """
        if isinstance(self.decoder, PatchDecoder):
            if outlines is None:
                raise ValueError("this network decodes under outlines, but none were given")
            candidates = find_candidates(outlines, z.shape[2])
            features = self.decoder(z, draw_hint(outlines, candidates, z.shape[2]))
            rows, inside = reach_cells(outlines, candidates, z.shape[2], PATCH)
            logits = self.decoder.occupancy(features, inside)
            if steady:
                agreed = steady_occupancy(from_patches(logits, z.shape[2]), outlines)
                logits = as_patches(agreed).masked_fill(~inside.any(dim=-1), NEVER)
            index = _occupied_patches(logits) if index is None else index
            return logits, self.decoder.attributes(features[index], rows[index], inside[index]), index
        dense = fold(self.decoder(z)).float().flatten(0, 1)
        logits = dense[..., 0]
        index = _occupied_patches(logits) if index is None else index
        return logits, dense[index][..., 1:], index

    def forward(
        self, patches: PatchBatch, noise: Float[Tensor, "B D X Y Z"], outlines: OutlineBatch | None = None
    ) -> Reconstruction:
        """Reconstructs a batch through a draw from its posterior."""
        mean, logvar = self.encode(patches)
        z = sample_gaussian(mean, logvar, noise)
        logits, attributes, _ = self.decode(z, patches.index, outlines)
        return Reconstruction(logits=logits, attributes=attributes, mean=mean, logvar=logvar)


@torch.no_grad()
def decode_cells(
    vae: StructureVae,
    z: Float[Tensor, "B D X Y Z"],
    outlines: OutlineBatch | None = None,
    *,
    steady: bool = False,
) -> tuple[list[VoxelFields], Float[Tensor, "B R R R"]]:
    """Fields of the occupied cells of latents, and the logits of all cells; above 0 a cell is occupied."""
    logits, attributes, index = vae.decode(z, outlines=outlines, steady=steady)
    per_sample = len(logits) // len(z)
    edge = round(per_sample ** (1 / 3))
    out = []
    for sample in range(len(z)):
        mine = (index >= sample * per_sample) & (index < (sample + 1) * per_sample)
        patch = index[mine] - sample * per_sample
        occupied = logits[index[mine]] > 0
        row, cell = occupied.nonzero(as_tuple=True)
        coords = PATCH * unravel(patch[row], edge) + unravel(cell, PATCH)
        out.append(_read(coords, attributes[mine][occupied], edge * PATCH))
    return out, from_patches(logits, edge)


def _read(coords: Int[Tensor, "N 3"], values: Float[Tensor, "N C"], resolution: int) -> VoxelFields:
    """Voxel fields of cells in the order of their flat index, as `artigen.voxels.fields.decode` gives."""
    flat = (coords[:, 0] * resolution + coords[:, 1]) * resolution + coords[:, 2]
    order = flat.argsort()
    values = values[order].float()
    units = torch.tensor([FULL_TURN, 1.0], device=values.device)
    found = {
        "label_probs": values[:, ROW.label].softmax(dim=1),
        "joint_probs": values[:, ROW.joint_type].softmax(dim=1),
        "axis": values[:, ROW.axis],
        "origin": values[:, ROW.origin],
        "ranges": values[:, ROW.range] * units,
        "box": values[:, ROW.box],
        "category_probs": values[:, ROW.category].softmax(dim=1),
        "coords": coords[order],
    }
    return VoxelFields(resolution=resolution, **{name: value.cpu().numpy() for name, value in found.items()})


def _occupied_patches(logits: Float[Tensor, "N K"]) -> Int[Tensor, "P"]:
    return (logits > 0).any(dim=1).nonzero()[:, 0]
