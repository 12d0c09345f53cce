"""Description of the networks of a model folder, read without PyTorch."""

import hashlib
import json
from pathlib import Path

from artigen.errors import SourceError

DESCRIPTION = "model.json"


def read_description(folder: Path) -> dict[str, dict[str, object]]:
    """Reads the description of the networks of a model folder.

    Raises:
        SourceError: If there is no such folder, or its description is no JSON, or another one.
    """
    path = folder / DESCRIPTION
    try:
        said = json.loads(path.read_text())
    except (FileNotFoundError, NotADirectoryError) as error:
        raise SourceError(f"{path}: there is no such model; train one, or give the folder of one") from error
    except OSError as error:
        raise SourceError(f"{path}: cannot be read ({error.strerror})") from error
    except ValueError as error:  # no JSON, or not even text
        raise SourceError(f"{path}: is no JSON ({error})") from error
    if not isinstance(said, dict) or not all(isinstance(value, dict) for value in said.values()):
        raise SourceError(f"{path}: expected what a model says about its networks, by their names")
    return said


def hash_model(folder: Path) -> str:
    """SHA-256 over the names and bytes of a model's description and weights: says which model it was."""
    digest = hashlib.sha256()
    for path in sorted([folder / DESCRIPTION, *folder.glob("*.safetensors")]):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()
