"""Models from folders, each loaded once per process."""

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from artigen.appearance.draw import AppearanceModel
    from artigen.latent.draw import StructureModel
    from artigen.sketch.network import SketchNetwork


@lru_cache(maxsize=1)
def hash_weights(folder: Path) -> str:
    """Hash of the weights of a model folder."""
    from artigen.models.description import hash_model

    return hash_model(folder)


def hash_file(path: Path) -> str:
    """Hash of a file's content; of nothing if the file cannot be read, which its reader reports."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return ""


@lru_cache(maxsize=1)
def load_sketch(folder: Path) -> "SketchNetwork":
    """The sketch network of a model folder."""
    from artigen.sketch.model import load_sketch_network

    return load_sketch_network(folder)


@lru_cache(maxsize=1)
def load_structure(folder: Path, encoders: Path | None) -> "StructureModel":
    """The paper's structure VAE and flow, with public encoders if their folder is given."""
    from artigen.latent.draw import load_structure_model
    from artigen.models.public_encoders import attach_encoders

    structure = load_structure_model(folder)
    if encoders is not None:
        attach_encoders(structure.flow, encoders)
    return structure


@lru_cache(maxsize=1)
def load_drawer(folder: Path) -> "AppearanceModel | None":
    """The sparse flow for generated voxels; None if the folder has no appearance weights."""
    from artigen.appearance.draw import has_appearance, load_appearance_model

    return load_appearance_model(folder) if has_appearance(folder) else None
