"""What a building prescribes for one of its rooms."""

from dataclasses import dataclass

from .recipes import Recipe
from .room import Opening, Side


@dataclass(frozen=True, kw_only=True)
class Site:
    """A room's place in a building, in the frame of the room, whose entrance is in its front wall.

    ``size`` is width, depth and height (m). ``span`` is the stretch of the front wall (m along it) in which
    the entrance lies. ``doorways`` lead to neighbours, whose doors open away from this room, and stay free.
    Windows fit into ``outer`` walls only.
    """

    recipe: Recipe
    size: tuple[float, float, float]
    span: tuple[float, float]
    doorways: tuple[Opening, ...]
    outer: tuple[Side, ...]
