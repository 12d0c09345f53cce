"""Semantic labels, Wikidata codes and non-visual materials.

Codes are assigned only where they are certain. An object without one is labelled as a physical object; a part
without one has none.
"""

# usd-core has no type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

from typing import TYPE_CHECKING

from artigen.kind import PHYSICAL_OBJECT, MaterialName, find_kind
from artigen.types import PartLabel
from sim_export.package import Link, SimPackage, Visual
from sim_export.physics.materials import MATERIALS, part_material

if TYPE_CHECKING:
    from pxr import Usd

PART_CODES: dict[PartLabel, str] = {"door": "Q36794", "wheel": "Q446"}
"""Wikidata items of part labels; drawers, handles, knobs, trays and shelves have none."""

MATERIAL_WORDS: dict[MaterialName, str] = {
    "wood_board": "wood",
    "steel_sheet": "steel",
    "steel": "steel",
    "glass": "glass",
    "insulating_glass": "glass",
    "plastic": "plastic",
    "rubber": "rubber",
    "foam_panel": "foam",
    "stone": "stone",
}
NONVISUAL_BASES: dict[MaterialName, str] = {
    **MATERIAL_WORDS, "glass": "clear_glass", "insulating_glass": "clear_glass", "foam_panel": "steel",
}  # fmt: skip
"""Surface material for radar and lidar, in SimReady's terms; a foam panel has a steel skin."""


def category_code(category: str) -> str:
    """The Wikidata code of a category, or of physical objects in general."""
    kind = find_kind(category)
    return PHYSICAL_OBJECT if kind is None else kind.wikidata or PHYSICAL_OBJECT


def visual_material(package: SimPackage, visual: Visual) -> MaterialName:
    """Material of a visual's part: from the package, else from its label and the category."""
    return _known(package, visual.part) or part_material(visual.label, package.category)


def link_material(package: SimPackage, link: Link) -> MaterialName:
    """Material of a link: that of its movable part."""
    for part in link.parts:
        known = _known(package, part)
        if known is not None:
            return known
    return part_material(link.label or "base", package.category)


def _known(package: SimPackage, part: str) -> MaterialName | None:
    said = dict(package.materials).get(part)
    return next((name for name in MATERIALS if name == said), None)


def add_label(prim: "Usd.Prim", taxonomy: str, word: str) -> None:
    """Labels a prim with a term of a taxonomy, such as ``class``, ``material`` or ``wikidata_qcode``."""
    from pxr import UsdSemantics

    labels = UsdSemantics.LabelsAPI.Apply(prim, taxonomy)
    labels.CreateLabelsAttr().Set([word])


def label_part(prim: "Usd.Prim", label: PartLabel | None) -> None:
    """Labels a prim with its part label; does nothing for an unknown one."""
    if label is None:
        return
    add_label(prim, "class", label)
    if label in PART_CODES:
        add_label(prim, "wikidata_qcode", PART_CODES[label])
