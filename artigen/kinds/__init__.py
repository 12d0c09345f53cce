"""One file per kind of object, with its record and the function that draws it; see `artigen.kind`.

The module can be called as ``artigen.kinds()``: it has the name of the function that lists the records.
"""

import sys
from collections.abc import Mapping
from types import ModuleType

from artigen.kind import Kind, kinds


class _Kinds(ModuleType):
    def __call__(self) -> Mapping[str, Kind]:
        """All records by name."""
        return kinds()


sys.modules[__name__].__class__ = _Kinds
