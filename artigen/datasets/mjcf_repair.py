"""Repairs of MJCF files that MuJoCo refuses although the program that they were written for reads them.

Such files name things of the scene that they are put into, define an asset twice (the first counts, as where
robosuite merges files), or hold elements of other programs. Only what no package needs is taken away, and
each repair is said.
"""

import re
from collections.abc import Callable
from pathlib import Path
from xml.etree.ElementTree import Element

UNUSED = ("actuator", "sensor", "tendon", "contact", "keyframe", "custom", "statistic", "visual", "size")
"""Sections of a file of which no package holds anything."""
NEEDED = frozenset(("mujoco", "worldbody", "body", "geom", "joint", "mesh", "asset", "include", "default"))
"""Elements that are never taken away."""


def repair(root: Element, error: str) -> str:
    """Takes away what an error of MuJoCo names, and says what; "" if nothing can be taken away.

    Args:
        root: Element ``mujoco``, changed in place.
        error: MuJoCo's message.
    """
    for pattern, change in REPAIRS.items():
        found = re.search(pattern, error)
        said = change(root, *found.groups()) if found is not None else ""
        if said:
            return said
    number = _remove(root, lambda above, element: above is root and element.tag in UNUSED)
    return f"sections that no package needs are left out ({number}), as MuJoCo refuses them" if number else ""


def _drop_elements(root: Element, tag: str) -> str:
    number = 0 if tag in NEEDED else _remove(root, lambda _, element: element.tag == tag)
    return f"elements <{tag}> that MJCF does not know are left out ({number})" if number else ""


def _drop_attributes(root: Element, name: str, tag: str) -> str:
    holders = [element for element in root.iter(tag) if element.attrib.pop(name, None) is not None]
    said = f"attributes {name!r} of <{tag}> that MJCF does not know are left out ({len(holders)})"
    return said if holders else ""


def _drop_repeated(root: Element, name: str, tag: str) -> str:
    named = [one for asset in root.iter("asset") for one in asset.findall(tag) if _name(one) == name]
    again = {id(element) for element in named[1:]}
    number = _remove(root, lambda _, element: id(element) in again)
    return f"{tag} {name!r} is defined {number + 1} times; the first counts" if number else ""


def _drop_material(root: Element, name: str) -> str:
    holders = [element for element in root.iter() if element.get("material") == name]
    for element in holders:
        del element.attrib["material"]
    return f"material {name!r} is missing, plain colours instead" if holders else ""


REPAIRS: dict[str, Callable[..., str]] = {
    r"unrecognized element.*Element '([^']+)'": _drop_elements,
    r"unrecognized attribute: '([^']+)'.*Element '([^']+)'": _drop_attributes,
    r"repeated name '([^']+)' in (\w+)": _drop_repeated,
    r"material '([^']+)' not found": _drop_material,
}
"""What is changed for which message."""


def _name(asset: Element) -> str:
    """Name of an asset: that of its file where it states none."""
    return asset.get("name") or Path(asset.get("file", "")).stem


def _remove(root: Element, chosen: Callable[[Element, Element], bool]) -> int:
    """Removes elements, chosen with what holds them, and returns their number."""
    number = 0
    for above in list(root.iter()):
        for element in [element for element in above if chosen(above, element)]:
            above.remove(element)
            number += 1
    return number
