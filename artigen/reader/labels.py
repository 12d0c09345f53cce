"""What the reader can name."""

from typing import get_args

from artigen.kind import list_words
from artigen.shapes.surfaces.finishes import FinishKind

KINDS = list_words()
"""Kinds of objects, in the order of their numbers in networks."""
THINGS = ("front", "pull", "dial", "shelf", "wheel", "object")
"""What is found at a place, each on a map of its own: fronts are doors and drawers, pulls are handles, dials
are knobs and buttons, shelves include trays and racks."""
FRONT, PULL, DIAL, SHELF, WHEEL, OBJECT = range(len(THINGS))
HINGES = ("left", "right", "top", "bottom")
"""Sides of a door as seen, on which its hinges are."""
MATERIALS = get_args(FinishKind)
"""Materials of a front's largest surface."""
STANDS = ("flat", "legs", "wheels")
"""How an object stands: on its base or a plinth, on legs, or on wheels."""
UNKNOWN = -1
"""Value of a mark's attribute that nobody has stated."""
