"""What other installed distributions add: kinds, checks, engines and export formats, by entry points."""

from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points
from typing import Any, Literal

from artigen.errors import ArtigenError

Group = Literal["artigen.kinds", "artigen.checks", "artigen.engines", "artigen.exporters"]


class PluginError(ArtigenError):
    """An extension cannot be used; the message names its distribution."""


@dataclass(frozen=True, kw_only=True)
class Plugin:
    """A value of an entry point, with the name of that and of its distribution."""

    name: str
    origin: str
    value: Any


@cache
def find_plugins(group: Group, kind: type | tuple[type, ...]) -> tuple[Plugin, ...]:
    """The values of all entry points of a group, sorted by name.

    Args:
        kind: What each must be.

    Raises:
        PluginError: If one cannot be imported or is something else, or two have one name.
    """
    found: dict[str, Plugin] = {}
    for entry in sorted(entry_points(group=group), key=lambda entry: entry.name):
        origin = entry.dist.name if entry.dist is not None else entry.value
        said = f"{origin}: entry point {entry.name!r} of {group}"
        if entry.name in found:
            raise PluginError(f"{said} is in {found[entry.name].origin} as well; uninstall one of them")
        try:
            value = entry.load()
        except Exception as error:  # what other people's modules raise is not known here
            raise PluginError(
                f"{said} cannot be loaded: {type(error).__name__}: {error}; repair or uninstall {origin}"
            ) from error
        if not isinstance(value, kind):
            wanted = " or ".join(each.__name__ for each in (kind if isinstance(kind, tuple) else (kind,)))
            raise PluginError(f"{said} is a {type(value).__name__}, expected a {wanted}")
        found[entry.name] = Plugin(name=entry.name, origin=origin, value=value)
    return tuple(found.values())
