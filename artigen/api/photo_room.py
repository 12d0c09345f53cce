"""`furnish_photographed`: the room of a photograph that shows a kitchen's wall."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from artigen.api.batch import run_with_progress
from artigen.api.generate import GenerateJob, GenerateSettings, generate_and_validate
from artigen.api.scene import PACKAGES, Furnished, Pictures, SceneFormat, SceneSettings, furnish_room
from artigen.errors import ArtigenError
from artigen.runtime.runner import LocalRunner, Runner
from artigen.weights import SHIPPED

if TYPE_CHECKING:
    from artigen.reader.wall.units import Unit, Wall

READINGS = "readings"
"""Subfolder of the room for the reading of each unit, to be edited and built again."""
AROUND, NARROWEST = 0.8, 2.4
"""Length (m) of the wall beyond the units, and its least length."""


@dataclass(frozen=True, kw_only=True)
class Photographed:
    """A room after a photograph, and what of that it does not show."""

    furnished: Furnished
    notes: tuple[str, ...]

    def describe(self) -> str:
        """The room in one line, and what differs from the photograph in further ones."""
        return "\n".join((self.furnished.describe(), *self.notes))


def furnish_photographed(
    photo: Path,
    out: Path,
    seed: int = 0,
    cfg: SceneSettings | None = None,
    *,
    formats: tuple[SceneFormat, ...] = ("mjcf",),
    pictures: Pictures = "all",
    runner: Runner | None = None,
) -> Photographed:
    """Reads the units along the wall of a kitchen, builds each of them, and orders them along a wall.

    Units stand in the read order with the read widths and free lengths between them; depths are the usual
    ones of what they are. A wall cabinet that cannot open above what stands below it is left out; where the
    units cannot open side by side with a robot before them, they only do not overlap. Both are said.

    Args:
        photo: A kitchen's wall from before it.
        out: Folder for ``scene.json``, pictures, packages and readings.
        seed: Seed of everything that is not seen.
        cfg: Properties of the room; without a width, the wall is a little longer than its units.
        formats: See `artigen.api.scene.furnish_room`.
        pictures: The same.
        runner: Where objects are made; default: one after the other in this process.

    Raises:
        ArtigenError: If the photograph shows no unit, no unit passes its checks, or they cannot be arranged.
    """
    from artigen.reader.wall.units import Unit, read_units

    asked = cfg or SceneSettings()
    if asked.place or asked.family is not None:
        raise ArtigenError("the photograph says what stands there and how it looks; omit place and family")
    wall = read_units(photo)
    named = _name_units(wall)
    passed = _make_packages(named, out, seed, runner or LocalRunner(workers=0))
    notes = list(wall.notes)
    notes += [f"{name}: does not pass its checks, left out" for name, _ in named if name not in passed]
    standing = [(name, unit) for name, unit in named if name in passed and unit in wall.standing]
    hung = [(name, unit) for name, unit in named if name in passed and unit in wall.hung]
    if not standing:
        raise ArtigenError(f"{photo}: no unit passes its checks: {', '.join(name for name, _ in named)}")

    def furnish(above: Sequence[tuple[str, Unit]], *, final: bool) -> Furnished:
        """The room with these wall cabinets."""
        words = [*_order(standing), *(["above", *_order(above)] if above else [])]
        length = sum(unit.size[1] for _, unit in standing) + sum(
            map(float, filter(_is_number, _order(standing)))
        )
        width = asked.width or round(max(NARROWEST, length + AROUND), 2)
        ordered = replace(asked, place=tuple(words), width=width)
        return furnish_room(
            "kitchen", out, seed, out / PACKAGES, ordered,
            formats=formats if final else (), pictures=pictures if final else "none",
        )  # fmt: skip

    try:
        furnish((), final=False)
    except ArtigenError as error:
        asked = replace(asked, sweeps="any")
        notes.append(f"not every door opens with a robot before it: {error}")
    kept: list[tuple[str, Unit]] = []
    for one in hung:
        try:
            furnish([*kept, one], final=False)
        except ArtigenError as error:
            notes.append(f"{one[0]}: left out, since {error}")
        else:
            kept.append(one)
    return Photographed(furnished=furnish(kept, final=True), notes=tuple(notes))


def _name_units(wall: "Wall") -> "list[tuple[str, Unit]]":
    """Units with the names of their packages."""
    units = (*wall.standing, *wall.hung)
    return [(f"{number:02d}_{unit.role.replace(' ', '_')}", unit) for number, unit in enumerate(units)]


def _make_packages(
    named: "Sequence[tuple[str, Unit]]", out: Path, seed: int, runner: Runner
) -> frozenset[str]:
    """Builds and checks a package for each unit; the names of those that pass."""
    (out / READINGS).mkdir(parents=True, exist_ok=True)
    jobs = []
    for name, unit in named:
        path = out / READINGS / f"{name}.json"
        path.write_text(json.dumps(unit.reading.to_json(), indent=1))
        depth, width, height = unit.size
        cfg = GenerateSettings(
            reading=path, depth=depth, width=width, height=height, compare=False, gaussians=False
        )
        jobs.append(
            GenerateJob(model=SHIPPED, category=None, seed=seed, out=out / PACKAGES, cfg=cfg, name=name)
        )
    done = run_with_progress(generate_and_validate, jobs, out / PACKAGES, runner=runner)
    return frozenset(job.key for job, one in zip(jobs, done, strict=True) if one.good)


def _order(named: "Sequence[tuple[str, Unit]]") -> list[str]:
    """Words of an order, with free lengths where the wall was seen between units."""
    from artigen.reader.wall.units import FREE

    words: list[str] = []
    end = 0.0
    for name, unit in named:
        free = round(unit.start - end, 2)
        words += [f"{free:.2f}"] if free >= FREE else []
        words.append(f"{unit.role}@{name}")
        end = (unit.start if free >= FREE else end) + unit.size[1]
    return words


def _is_number(word: str) -> bool:
    return word.replace(".", "").isdigit()
