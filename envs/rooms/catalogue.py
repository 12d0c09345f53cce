"""Catalogue of the packages in a folder: category, size, joints, and whether validation passed."""

import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from artigen.errors import ArtigenError, explain
from artigen.kind import Place, find_kind
from sim_export.files.folders import list_packages
from sim_export.files.sidecars import FORMAT
from sim_export.report import report_from_json

from .recipes import Recipe, Role


class PopulateError(ArtigenError):
    """A room cannot be furnished; the message states what was found and what is needed."""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A validated package. ``size`` is depth, width and height in metres, ``kinds`` the kinds of its
    joints."""

    folder: Path
    name: str
    category: str
    size: tuple[float, float, float]
    kinds: tuple[str, ...]
    provenance: tuple[tuple[str, str], ...]

    @property
    def suite(self) -> tuple[str, int] | None:
        """Family and suite of its look; None of objects that no suite dressed."""
        source = dict(self.provenance)
        both = {"family", "suite"} <= source.keys()
        return (source["family"], int(source["suite"])) if both else None


@dataclass(frozen=True, kw_only=True)
class Catalogue:
    """Validated packages in order of their names; ``failed`` are excluded ones, with their failed checks."""

    folder: Path
    entries: tuple[Entry, ...]
    failed: tuple[str, ...] = ()

    def of_role(self, role: Role) -> tuple[Entry, ...]:
        """The packages that fit a role."""
        return tuple(entry for entry in self.entries if fits_role(entry, role))


def fits_role(entry: Entry, role: Role) -> bool:
    """Whether category, size and joints match the role."""
    kind = find_kind(entry.category)
    return kind is not None and any(_fits(entry, place) for place in kind.places if place.role == role.name)


def _fits(entry: Entry, place: Place) -> bool:
    right_size = all(
        low <= size <= high for low, size, high in zip(place.low, entry.size, place.high, strict=True)
    )
    return right_size and (place.joint is None or place.joint in entry.kinds)


def read_catalogue(folder: Path) -> Catalogue:
    """All packages in ``folder``, at any depth, with a passed validation.json.

    Raises:
        PopulateError: If the folder is missing or has no package, or none of them passed.
    """
    folder = folder.resolve()
    if not folder.is_dir():
        raise PopulateError(f"{folder}: no such folder; give a folder of packages, or none to draw objects")
    found = list_packages(folder)
    if not found:
        raise PopulateError(
            f"{folder}: holds no package (a folder with mobility.urdf); `artigen shape` writes some"
        )
    entries, failed, foreign = [], [], []
    for package in found:
        verdict = _verdict(package)
        if verdict:
            failed.append(f"{package.name} ({verdict})")
        elif (entry := _read_entry(package)) is None:
            foreign.append(package.name)
        else:
            entries.append(entry)
    if not entries:
        reasons = [
            f"{len(failed)} did not pass, {failed[0]} is the first" if failed else "",
            f"{len(foreign)} not written by artigen, {foreign[0]} is the first" if foreign else "",
        ]
        raise PopulateError(
            f"{folder}: {len(found)} packages and none that can be used: "
            f"{'; '.join(reason for reason in reasons if reason)}; "
            "a room needs packages that passed `artigen validate`"
        )
    return Catalogue(folder=folder, entries=tuple(entries), failed=tuple(failed))


def read_entry(package: Path) -> Entry:
    """One package.

    Raises:
        PopulateError: If it did not pass validation, or was not written by artigen.
    """
    verdict = _verdict(package)
    entry = None if verdict else _read_entry(package)
    if entry is None:
        raise PopulateError(
            f"{package}: {verdict or 'not written by artigen'}; a room needs packages that passed "
            "`artigen validate`"
        )
    return entry


def demand_roles(catalogue: Catalogue, recipe: Recipe) -> None:
    """Raises `PopulateError` unless every required role of the room has a package."""
    missing = [role for role in recipe.needed if not catalogue.of_role(role)]
    if not missing:
        return
    counts = Counter(entry.category for entry in catalogue.entries)
    there = ", ".join(f"{count} {name}" for name, count in sorted(counts.items()))
    wanted = "; ".join(describe_role(role) for role in missing)
    more = f", besides {len(catalogue.failed)} that failed validation" if catalogue.failed else ""
    raise PopulateError(
        f"{catalogue.folder}: nothing in it can be the {wanted} that the {recipe.kind} needs; "
        f"it has {there}{more}"
    )


def describe_role(role: Role) -> str:
    """A role in words: its name, categories and sizes."""
    by_size: dict[str, list[str]] = {}
    for name, place in role.places:
        by_size.setdefault(_describe_size(place), []).append(name)
    filled = "; or ".join(f"{' or '.join(names)}, {size}" for size, names in by_size.items())
    return f"{role.name} ({filled})"


def _describe_size(place: Place) -> str:
    names = ("deep", "wide", "high")
    return ", ".join(
        f"{low:g} to {high:g} m {name}" for low, high, name in zip(place.low, place.high, names, strict=True)
    )


def _verdict(package: Path) -> str:
    """Reason why a package is not validated; empty if it is."""
    path = package / "validation.json"
    if not path.is_file():
        return "no validation.json"
    try:
        report = report_from_json(path.read_text())
    except (ValueError, KeyError, TypeError) as err:
        raise PopulateError(f"{path}: not a report of `artigen validate` ({err})") from err
    return "" if report.passed else "failed " + ", ".join(check.id for check in report.failures[:3])


def _read_entry(package: Path) -> Entry | None:
    """A package as an entry; None for a foreign format."""
    meta = _json(package / "meta.json")
    if meta.get("format") != FORMAT:
        return None
    bounds = _json(package / "bounding_box.json")
    physics = _json(package / "physics.json")
    provenance = _json(package / "provenance.json")
    try:
        x, y, z = (float(high) - float(low) for low, high in zip(bounds["min"], bounds["max"], strict=True))
        return Entry(
            folder=package,
            name=meta["model_id"],
            category=meta["model_cat"],
            size=(x, y, z),
            kinds=tuple(sorted({joint["kind"] for joint in physics["joints"]})),
            provenance=tuple(sorted((key, str(value)) for key, value in provenance.items())),
        )
    except (KeyError, TypeError, ValueError) as err:
        raise PopulateError(
            f"{package}: its JSON files do not have the expected structure ({err!r})"
        ) from err


def _json(path: Path) -> dict:
    try:
        value = json.loads(path.read_text())
    except (OSError, ValueError) as err:
        raise PopulateError(f"{path}: cannot be read ({explain(err)})") from err
    if not isinstance(value, dict):
        raise PopulateError(f"{path}: holds a {type(value).__name__}, expected an object")
    return value
