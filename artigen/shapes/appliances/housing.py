"""`Housing`: the size of an appliance with doors and controls before its housing, and what it stands on."""

from dataclasses import dataclass

from artigen.shapes.appliances.cavity import build_feet
from artigen.shapes.fittings.feet import make_plinth
from artigen.shapes.fittings.hardware import GAP
from artigen.shapes.primitives import Primitive
from artigen.shapes.ranges import Range


@dataclass(frozen=True, kw_only=True)
class Housing:
    """Dimensions (m) of an appliance that is centred above the origin."""

    width: float
    depth: float
    height: float
    thickness: float
    """Thickness of doors."""

    @property
    def x(self) -> float:
        """x of the front face of doors and controls."""
        return -self.depth / 2

    @property
    def front(self) -> float:
        """x of the front face of the housing."""
        return self.x + self.thickness + GAP

    @property
    def back(self) -> float:
        """x of the rear face."""
        return self.depth / 2

    @property
    def y(self) -> Range:
        """Right and left side."""
        return -self.width / 2, self.width / 2

    @property
    def longest(self) -> float:
        """Longest edge."""
        return max(self.width, self.depth, self.height)

    def build_stand(
        self, height: float, setback: float, *, radius: float, inset: float
    ) -> tuple[Primitive, ...]:
        """A closed base ``setback`` behind the front of the housing, or four feet where that is 0."""
        if setback:
            return make_plinth((self.front + setback, self.back), self.y, height)
        return build_feet((self.front, self.back), self.y, height, "leg", radius=radius, inset=inset)
