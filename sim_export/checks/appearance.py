"""L1: textures cover the whole mesh and are filled everywhere (V106)."""

from pathlib import PurePosixPath

import numpy as np

from sim_export.checks.config import CheckConfig
from sim_export.checks.geometry import own_visuals
from sim_export.checks.registry import CheckSpec, Finding
from sim_export.checks.subject import Shape, Subject
from sim_export.files.obj import parse_mtl, read_image
from sim_export.geometry.sampling import triangle_areas

_SPOTS = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4]]) / np.array([[3], [6], [6], [6]])
"""Sample points on each face: its centre, and halfway to the corners (barycentric)."""


def has_texture(subject: Subject) -> str:
    """Applies if a mesh that we made has a texture."""
    reason = own_visuals(subject)
    if reason or any(_image_of(subject, shape) for shape in subject.visuals):
        return reason
    return "no visual mesh has a texture"


def check_texture(subject: Subject, cfg: CheckConfig) -> Finding:
    """V106: every face is mapped to an area of the texture that is not black, outside and inside."""
    shares = {}
    images: dict[str, np.ndarray] = {}
    for shape in subject.visuals:
        image = _image_of(subject, shape)
        if not image:
            continue
        if image not in images:
            images[image] = read_image(subject.folder / image)
        shares[shape.file] = _shown(shape, images[image])
    where = min(shares, key=lambda name: shares[name])
    return Finding(
        passed=shares[where] >= cfg.min_texture_coverage,
        value=shares[where],
        threshold=cfg.min_texture_coverage,
        unit="of the area",
        where=where,
        message=f"{where}: {100 * shares[where]:.4g} % of the area shows a color of the texture, "
        f"at least {100 * cfg.min_texture_coverage:g} % must",
    )


def _image_of(subject: Subject, shape: Shape) -> str:
    """The image that a visual mesh uses, relative to the folder, or ""."""
    if not shape.obj.libraries or not len(shape.faces):
        return ""
    folder = PurePosixPath(shape.file).parent
    materials = parse_mtl(subject.folder / folder / shape.obj.libraries[-1])
    _, image = materials.get(shape.obj.face_materials[0], (None, ""))
    return str(folder / image) if image else ""


def _shown(shape: Shape, image: np.ndarray) -> float:
    """Share of the surface with non-degenerate texture coordinates and a colour that is not black."""
    faces = shape.obj.uv_faces
    area = triangle_areas(shape.triangles)
    placed = (faces >= 0).all(axis=1)
    uv = np.zeros((len(faces), 3, 2))
    uv[placed] = shape.obj.coords[faces[placed]]
    placed &= (uv >= -1e-6).all(axis=(1, 2)) & (uv <= 1.0 + 1e-6).all(axis=(1, 2))
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    placed &= np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) > 1e-12
    height, width = image.shape[:2]
    at = np.einsum("sc,fcd->fsd", _SPOTS, uv)
    column = np.clip((at[..., 0] * width).astype(np.int64), 0, width - 1)
    row = np.clip(((1.0 - at[..., 1]) * height).astype(np.int64), 0, height - 1)
    lit = (image[row, column, :3] > 0).any(axis=2).mean(axis=1)
    return float((area * placed * lit).sum() / max(area.sum(), 1e-12))


APPEARANCE_CHECKS = (
    CheckSpec(id="V106", level="L1", title="texture", applies=has_texture, function=check_texture),
)
