"""`restyle`: an object in other finishes, without new geometry."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from artigen.api.object import Object, load
from artigen.errors import ArtigenError

if TYPE_CHECKING:
    from sim_export.package import SimPackage


def restyle(obj: Object | Path | str, seed: int = 0, style: str | None = None) -> Object:
    """An object in the finishes of another one of its kind, as they are sold together; its geometry stays.

    Args:
        obj: An object of the grammar or the model, or the folder of its package.
        seed: Seed of the looks.
        style: A style of the kind, such as navy or steel; sampled from the seed if None.

    Raises:
        ArtigenError: If the seed is below 0, or the kind or its style is unknown.
        PackageError: If its visuals do not show finishes, as those of converted objects.
    """
    from artigen.shapes.restyle import draw_finishes, wear_finishes
    from sim_export.appearance.restyle import restyle_package

    if seed < 0:
        raise ArtigenError(f"seed {seed} of a look: expected one from 0")
    obj = obj if isinstance(obj, Object) else load(obj)
    finishes = draw_finishes(obj.kind, seed, style)
    shape = obj.shape
    if shape is not None:
        finishes = wear_finishes(dict(shape.finishes), finishes)
        shape = replace(shape, finishes=tuple(sorted(finishes.items())))

    def build() -> "SimPackage":
        return restyle_package(obj.package, finishes)

    return Object(name=obj.name, kind=obj.kind, build=build, shape=shape, scratch=obj.scratch)
