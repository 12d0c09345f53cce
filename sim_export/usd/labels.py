"""What objects, links and materials are called in USD: labels, Wikidata items, base materials of sensors."""

from dataclasses import dataclass

from artigen.types import PartLabel
from sim_export.physics.materials import MaterialName

PHYSICAL_OBJECT = "Q223557"
"""Wikidata's item for anything that can be touched: the category of what the table below does not hold."""
CATEGORY_ITEMS: dict[str, str] = {
    "StorageFurniture": "Q14745",  # furniture
    "Table": "Q14748",
    "Refrigerator": "Q37828",
    "Dishwasher": "Q186263",
    "Oven": "Q36539",
    "WashingMachine": "Q124441",
    "Microwave": "Q127956",
}
LABEL_ITEMS: dict[PartLabel, str] = {"door": "Q36794"}


@dataclass(frozen=True, kw_only=True)
class Substance:
    """A material's everyday name, and the base material by which sensors that do not see light take it."""

    label: str
    base: str


SUBSTANCES: dict[MaterialName, Substance] = {
    "wood_board": Substance(label="wood", base="wood"),
    "steel_sheet": Substance(label="steel", base="steel"),
    "steel": Substance(label="steel", base="steel"),
    "glass": Substance(label="glass", base="clear_glass"),
    "insulating_glass": Substance(label="glass", base="clear_glass"),
    "plastic": Substance(label="plastic", base="plastic"),
    "rubber": Substance(label="rubber", base="rubber"),
    "foam_panel": Substance(label="steel", base="steel"),  # what shows is the panel's skin
    "stone": Substance(label="stone", base="stone"),
}


def category_item(category: str) -> str:
    """The Wikidata item of a category."""
    return CATEGORY_ITEMS.get(category, PHYSICAL_OBJECT)
