"""Other looks for the same geometry: finishes as another object of the kind wears them."""

from artigen.shapes.draw import Wish, draw_shape, wear
from artigen.shapes.surfaces.finishes import Finish


def draw_finishes(category: str, seed: int, style: str | None = None) -> dict[str, Finish]:
    """The finishes of an object of a kind by role, as they are sold together.

    Args:
        category: The kind.
        seed: Seed of the looks.
        style: A style of the kind, such as navy or steel; sampled from the seed if None.

    Raises:
        ShapeError: If the kind or its style is unknown.
    """
    return dict(draw_shape(category, seed, Wish(style=style)).finishes)


def wear_finishes(own: dict[str, Finish], others: dict[str, Finish]) -> dict[str, Finish]:
    """The other finishes for the roles of an object; its own where the others lack a role, or where only one
    of the two is clear."""
    return {role: wear(finish, others.get(role, finish)) for role, finish in own.items()}
