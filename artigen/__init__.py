"""artigen: articulated objects for simulation, from a condition to a proven package.

``sample``, ``generate``, ``convert`` and ``load`` give an `Object`; ``kinds()`` lists what can be sampled.
Everything is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from artigen.api.entry import convert, generate, sample
    from artigen.api.grasps import grasps
    from artigen.api.object import Object, load
    from artigen.api.objects import Objects
    from artigen.api.restyle import restyle
    from artigen.kind import kinds

__version__ = "0.2.0"
__all__ = ["Object", "Objects", "convert", "generate", "grasps", "kinds", "load", "restyle", "sample"]

_PLACES = {
    "Object": "artigen.api.object",
    "Objects": "artigen.api.objects",
    "convert": "artigen.api.entry",
    "generate": "artigen.api.entry",
    "grasps": "artigen.api.grasps",
    "kinds": "artigen.kind",
    "load": "artigen.api.object",
    "restyle": "artigen.api.restyle",
    "sample": "artigen.api.entry",
}


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        raise AttributeError(f"module 'artigen' has no attribute {name!r}; it has {', '.join(__all__)}")
    return getattr(import_module(_PLACES[name]), name)
