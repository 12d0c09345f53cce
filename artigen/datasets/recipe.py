"""Recipes of data sets for `artigen dataset`, read from YAML and checked before anything is made.

Every error names the file, the line and the key, what was found and what is allowed.
"""

import json
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from artigen.datasets.packing import digest, need
from artigen.errors import ArtigenError, explain, name_options
from artigen.kind import kinds
from artigen.shapes.draw import Wish
from artigen.types import PartLabel

Validation = Literal["full", "none"]
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")
"""Pattern of names: they become keys of samples, which end at the first dot, and file names."""
MAX_COUNT = 10_000_000
MAX_SEED = 2**31 - 1


class RecipeError(ArtigenError):
    """A recipe is malformed, or requests something unknown or impossible."""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One entry of a recipe: a number of objects of one category."""

    name: str
    """Prefix of the ids of its objects: ``name-seed``, or ``name-gseed`` for generated ones."""
    category: str
    count: int
    seed: int = 0
    """Seed of the first object; objects that fail a check or are duplicates are replaced by later seeds."""
    generated: float = 0.0
    """Share of the objects that the trained model draws; the grammar draws the others."""
    like: int | None = None
    """Seed of an object whose topology all objects of the entry get."""
    wish: Wish = field(default_factory=Wish)
    line: int = 0
    """Line of the entry in the recipe."""

    @property
    def drawn_by_model(self) -> int:
        """Number of objects that the model draws."""
        return round(self.generated * self.count)


@dataclass(frozen=True, kw_only=True)
class Options:
    """Settings of the making and storing of objects."""

    gaussians: bool = False
    """Whether packages also hold Gaussians."""
    validation: Validation = "full"
    """``full``: keep only objects that pass every check; ``none``: keep all, unchecked."""
    redraws: int = 3
    """Most redraws of a generated object that fails a check."""
    thumbnail: int = 192
    """Edge of a picture in pixels; a thumbnail is two of them, closed and open."""
    objects_per_shard: int = 500
    near: float = 0.02
    """Two objects with at most this share of their surface in different places are duplicates; with 0, only
    objects of equal geometry are."""


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """Everything that determines a data set."""

    name: str
    title: str = ""
    description: str = ""
    license: str = "cc-by-4.0"
    """Licence of the data, as abbreviated by Hugging Face."""
    creator: str = "artigen"
    url: str = ""
    """Where the data set is published, for its metadata."""
    date: str = ""
    """Date of publication, YYYY-MM-DD."""
    objects: tuple[Entry, ...]
    options: Options = field(default_factory=Options)

    @property
    def count(self) -> int:
        """Number of objects."""
        return sum(entry.count for entry in self.objects)


def digest_recipe(recipe: Recipe) -> str:
    """Digest of the content of a recipe, independent of line numbers."""
    value = asdict(recipe)
    for entry in value["objects"]:
        entry.pop("line")
    return digest(json.dumps(value, sort_keys=True).encode())[:16]


def read_recipe(path: Path) -> Recipe:
    """Reads a recipe.

    Raises:
        RecipeError: If the file cannot be read, is not YAML, or holds an unknown key or an invalid value.
    """
    try:
        text = path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise RecipeError(f"{path}: cannot be read ({explain(error)})") from error
    return parse_recipe(text, str(path))


def parse_recipe(text: str, where: str = "recipe") -> Recipe:
    """The recipe in a YAML text; errors begin with ``where``."""
    yaml = need("yaml")
    try:
        node = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f" line {mark.line + 1}" if mark else ""
        raise RecipeError(f"{where}{line}: not YAML ({getattr(error, 'problem', error)})") from error
    if node is None:
        raise RecipeError(f"{where}: is empty; expected the keys name and objects")
    root = _Value(node=node, key="", where=where)
    fields = root.fields(
        {
            "name": _Value.name,
            "title": _Value.text,
            "description": _Value.text,
            "license": _Value.text,
            "creator": _Value.text,
            "url": _Value.text,
            "date": _Value.date,
            "objects": _read_entries,
            "options": _read_options,
        },
        required=("name", "objects"),
    )
    return Recipe(**fields)


@dataclass(frozen=True, kw_only=True)
class _Value:
    """A node of the YAML tree, with its key for errors."""

    node: Any
    key: str
    where: str

    def error(self, text: str) -> RecipeError:
        key = f" {self.key}:" if self.key else ""
        return RecipeError(f"{self.where} line {self.line}:{key} {text}")

    @property
    def line(self) -> int:
        return self.node.start_mark.line + 1

    def scalar(self, tag: str, what: str) -> str:
        if self.node.id != "scalar" or self.node.tag != f"tag:yaml.org,2002:{tag}":
            found = {"mapping": "keys", "sequence": "a list"}.get(self.node.id, repr(self.node.value))
            raise self.error(f"found {found}, expected {what}")
        return self.node.value

    def text(self) -> str:
        return self.scalar("str", "a text")

    def name(self) -> str:
        text = self.scalar("str", "a name")
        if not NAME.fullmatch(text):
            raise self.error(f"found {text!r}, expected letters, digits, - and _")
        return text

    def date(self) -> str:
        value = self.node.value if self.node.id == "scalar" else ""
        if not re.fullmatch(r"\d{4}-\d{2}-\d{2}", value):
            raise self.error(f"found {value!r}, expected a date as YYYY-MM-DD")
        return value

    def flag(self) -> bool:
        return self.scalar("bool", "true or false").lower() in ("true", "yes", "on")

    def whole(self, low: int, high: int) -> int:
        what = f"a whole number from {low} to {high}"
        value = self.scalar("int", what)
        try:
            number = int(value.replace("_", ""))
        except ValueError as error:
            raise self.error(f"found {value!r}, expected {what}") from error
        if not low <= number <= high:
            raise self.error(f"found {number}, expected {what}")
        return number

    def number(self, low: float, high: float) -> float:
        what = f"a number from {low:g} to {high:g}"
        kind = "int" if self.node.tag.endswith(":int") else "float"
        try:
            number = float(self.scalar(kind, what))
        except ValueError as error:
            raise self.error(f"found {self.node.value!r}, expected {what}") from error
        if not low <= number <= high:
            raise self.error(f"found {number:g}, expected {what}")
        return number

    def choice(self, words: tuple[str, ...]) -> str:
        text = self.node.value if self.node.id == "scalar" else None
        if text not in words:
            raise self.error(f"found {text!r}, expected {name_options(str(text), words)}")
        return text

    def pairs(self) -> Iterator[tuple[str, "_Value"]]:
        if self.node.id != "mapping":
            raise self.error("expected keys with values")
        seen = set()
        for key, value in self.node.value:
            name = str(key.value)
            child = _Value(node=value, key=f"{self.key}.{name}" if self.key else name, where=self.where)
            if name in seen:
                raise child.error("occurs twice, expected once")
            seen.add(name)
            yield name, child

    def items(self) -> list["_Value"]:
        if self.node.id != "sequence":
            raise self.error("expected a list")
        return [
            _Value(node=value, key=f"{self.key}[{index}]", where=self.where)
            for index, value in enumerate(self.node.value)
        ]

    def fields(
        self, known: Mapping[str, Callable[["_Value"], Any]], required: tuple[str, ...] = ()
    ) -> dict[str, Any]:
        values = {}
        for name, child in self.pairs():
            if name not in known:
                raise child.error(f"no such key; expected {name_options(name, known)}")
            values[name] = known[name](child)
        missing = [name for name in required if name not in values]
        if missing:
            raise self.error(f"{' and '.join(missing)} missing")
        return values


def _read_entries(value: _Value) -> tuple[Entry, ...]:
    entries: list[Entry] = []
    for item in value.items():
        entry = _read_entry(item)
        other = next((one for one in entries if one.name == entry.name), None)
        if other is not None:
            raise item.error(
                f"is called {entry.name}, like the entry in line {other.line}; give one of them another name"
            )
        entries.append(entry)
    if not entries:
        raise value.error("no entry, expected at least one")
    return tuple(entries)


def _read_entry(value: _Value) -> Entry:
    known = tuple(kinds())
    fields = value.fields(
        {
            "name": _Value.name,
            "category": lambda child: child.choice(known),
            "count": lambda child: child.whole(1, MAX_COUNT),
            "seed": lambda child: child.whole(0, MAX_SEED),
            "generated": lambda child: child.number(0.0, 1.0),
            "like": lambda child: child.whole(0, MAX_SEED),
            "wish": _read_wish,
        },
        required=("category", "count"),
    )
    fields.setdefault("name", fields["category"])
    if fields.get("like") is not None and fields.get("generated", 0.0) > 0.0:
        raise value.error("has both like and generated; the model does not draw objects of one topology")
    return Entry(**fields, line=value.line)


def _read_wish(value: _Value) -> Wish:
    def length(child: _Value) -> float:
        return child.number(0.02, 10.0)

    known = {"width": length, "depth": length, "height": length, "style": _Value.text, "counts": _read_counts}
    return Wish(**value.fields(known))


def _read_counts(value: _Value) -> tuple[tuple[PartLabel, int], ...]:
    known = {label: lambda child: child.whole(0, 100) for label in get_args(PartLabel)}
    return tuple(sorted(value.fields(known).items()))  # type: ignore[arg-type]


def _read_options(value: _Value) -> Options:
    return Options(
        **value.fields(
            {
                "gaussians": _Value.flag,
                "validation": lambda child: child.choice(get_args(Validation)),
                "redraws": lambda child: child.whole(0, 100),
                "thumbnail": lambda child: child.whole(32, 1024),
                "objects_per_shard": lambda child: child.whole(1, 100_000),
                "near": lambda child: child.number(0.0, 1.0),
            }
        )
    )
