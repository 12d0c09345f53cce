"""`merge_datasets`: several data sets as one, without duplicates; samples keep their bytes."""

from collections.abc import Sequence
from pathlib import Path

from artigen.datasets.duplicates import Duplicate, Duplicates, Fingerprint
from artigen.datasets.manifest import About
from artigen.datasets.packing import PackingError, digest
from artigen.datasets.publish import PackedObject, is_full, order_objects, write_dataset
from artigen.datasets.recipe import NAME, Options
from artigen.datasets.shards import ARCHIVE, Shards

COLUMNS = ("id", "category", "joint_kinds", "depth", "width", "height", "geometry", "package", "descriptor")


def merge_datasets(sources: Sequence[Shards], out: Path, generator: str) -> Path:
    """Writes the objects of several data sets as one; of duplicates, the first one is kept.

    Raises:
        PackingError: If licences differ, or two different objects have one id.
    """
    licenses = {one.index["license"]: one.folder for one in sources}
    if len(licenses) > 1:
        found = " and ".join(f"{license} ({folder})" for license, folder in licenses.items())
        raise PackingError(f"licences differ: {found}; only data sets of one licence can be merged")
    near = min(float(one.index["near"]) for one in sources)
    places: dict[str, Shards] = {}
    descriptors: dict[str, bytes] = {}
    packages: dict[str, str] = {}
    kept, duplicates = Duplicates(near), list[Duplicate]()
    for source in sources:
        table = source.manifest(*COLUMNS).to_pydict()
        for row, name in enumerate(table["id"]):
            values = {key: table[key][row] for key in COLUMNS}
            if packages.get(name, values["package"]) != values["package"]:
                raise PackingError(
                    f"{name}: is another object in {places[name].folder} than in {source.folder}; give the "
                    "entries of their recipes different names or seeds"
                )
            duplicate = kept.add(
                Fingerprint(
                    id=name,
                    category=values["category"],
                    joints=tuple(values["joint_kinds"]),
                    extents=(values["depth"], values["width"], values["height"]),
                    geometry=values["geometry"],
                    descriptor=values["descriptor"],
                )
            )
            if duplicate is not None:
                duplicates.append(duplicate)
                continue
            places[name], descriptors[name], packages[name] = source, values["descriptor"], values["package"]
    full = {name for name, source in places.items() if is_full(source[name].sample)}

    def load(name: str) -> PackedObject:
        item = places[name][name]
        return PackedObject(
            sample=item.sample,
            thumbnail=item.thumbnail,
            archive=item.members[ARCHIVE],
            descriptor=descriptors[name],
        )

    def fetch(sha256: str) -> bytes:
        source = next(one for one in sources if sha256 in one.shared_places)
        return source.shared_file(sha256)

    return write_dataset(
        out,
        order_objects(list(places), full.__contains__),
        load,
        fetch,
        _describe(sources, out, generator, tuple(duplicates), near),
        per_shard=Options().objects_per_shard,
    )


def _describe(
    sources: Sequence[Shards], out: Path, generator: str, duplicates: tuple[Duplicate, ...], near: float
) -> About:
    first = sources[0].index
    names = ", ".join(dict.fromkeys(one.index["name"] for one in sources))
    recipes: dict[str, str] = {}
    for source in sources:
        for path in sorted((source.folder / "recipes").iterdir()):
            text = path.read_text()
            name = path.name
            while recipes.get(name, text) != text:
                name = f"other-{name}"
            recipes[name] = text
    return About(
        name=out.name if NAME.fullmatch(out.name) else first["name"],
        title=first["title"] if len({one.index["title"] for one in sources}) == 1 else out.name,
        description=first["description"] or f"Merged from {names}.",
        license=first["license"],
        creator=first["creator"],
        url=first["url"],
        date=first["date"],
        generator=generator,
        recipes=tuple(recipes.items()),
        digest=digest("\n".join(one.index["recipe"] for one in sources).encode())[:16],
        duplicates=duplicates,
        near=near,
    )
