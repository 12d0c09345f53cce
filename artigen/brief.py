"""Short texts of values that hold thousands of numbers."""

from dataclasses import fields
from reprlib import Repr
from typing import Any

SHORT = Repr()
SHORT.maxtuple = SHORT.maxlist = SHORT.maxdict = 2
SHORT.maxstring = SHORT.maxother = 60


class Brief:
    """Base of dataclasses (with ``repr=False``) whose ``repr`` fits a screen: long fields are cut."""

    def __repr__(self) -> str:
        values: Any = self
        told = (f"{each.name}={SHORT.repr(getattr(self, each.name))}" for each in fields(values))
        return f"{type(self).__name__}({', '.join(told)})"
