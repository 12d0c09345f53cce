"""Contacts that SAPIEN ignores between links of one object, for more pairs than its loader takes.

SAPIEN's loader spends one of 31 bits on each pair of an SRDF. Links of which no two touch, such as the keys
of a keyboard, can share one.
"""

import xml.etree.ElementTree as ET
from collections.abc import Collection, Mapping
from itertools import combinations
from pathlib import Path
from typing import Any

from sim_export.files.mjcf import MAX_PAIRS


def share_bits(pairs: Collection[frozenset[str]], joined: Collection[frozenset[str]]) -> Mapping[str, int]:
    """A mask for every link of a pair: two masks share a bit only if the links are a pair or joined.

    Args:
        pairs: Pairs of links without contact, the most important first; the last ones are left out where they
            need more than `MAX_PAIRS` groups.
        joined: Pairs that engines ignore anyway.
    """
    masks: dict[str, int] = {}
    left, allowed = list(dict.fromkeys(pairs)), {*pairs, *joined}
    names = list(dict.fromkeys(name for pair in left for name in sorted(pair)))
    for bit in range(MAX_PAIRS):
        if not left:
            break
        group = set(left[0])
        for name in names:
            if name not in group and all(frozenset((name, other)) in allowed for other in group):
                group.add(name)
        for name in group:
            masks[name] = masks.get(name, 0) | 1 << bit
        shared = {frozenset(pair) for pair in combinations(group, 2)}
        left = [pair for pair in left if pair not in shared]
    return masks


def ignore_links(builder: Any, srdf: Path) -> None:
    """Gives the links of SAPIEN's builder of an articulation the masks of all pairs that an SRDF names."""
    rows = ET.parse(srdf).getroot().findall("disable_collisions")
    pairs = [frozenset((row.attrib["link1"], row.attrib["link2"])) for row in rows]
    joined = {frozenset((k.name, k.parent.name)) for k in builder.link_builders if k.parent is not None}
    masks = share_bits([pair for pair in pairs if pair not in joined], joined)
    for link in builder.link_builders:
        link.collision_groups[2] = masks.get(link.name, 0)
