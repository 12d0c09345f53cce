"""Libraries of the extra ``dataset``, imported on demand."""

from importlib import import_module
from types import ModuleType

from artigen.errors import ArtigenError


def need(module: str) -> ModuleType:
    """The module of that name.

    Raises:
        ArtigenError: If it is not installed; says what to install.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        raise ArtigenError(
            f'{error.name} is not installed, data sets need it: pip install "artigen[dataset]"'
        ) from error
