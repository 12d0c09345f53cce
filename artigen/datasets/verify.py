"""`verify_dataset`: checks every file and every record of a data set."""

from collections.abc import Iterator

from tqdm import tqdm

from artigen.datasets.manifest import SHARED_INDEX
from artigen.datasets.packing import LISTING, PackingError, digest, digest_file
from artigen.datasets.samples import Sample
from artigen.datasets.shards import SHARDS, SHARED, Shards, StoredObject


def verify_dataset(shards: Shards) -> list[str]:
    """Every problem of a data set, one sentence each; empty if it is intact.

    Checks every file of ``dataset.json``, every sample, every row of the manifest and every shared file, and
    unpacks every package.
    """
    try:
        return [*_verify_files(shards), *_verify_objects(shards)]
    except PackingError as error:
        return [*_verify_files(shards), str(error)]


def _verify_files(shards: Shards) -> Iterator[str]:
    """Problems of files: wrong size or SHA-256, and unknown files in the folders that readers use."""
    known = shards.index["files"]
    for folder in (SHARDS, SHARED):
        for path in sorted((shards.folder / folder).rglob("*")):
            if path.relative_to(shards.folder).as_posix() not in known:
                yield f"{path} is not part of the data set"
    for name, facts in known.items():
        path = shards.folder / name
        if not path.is_file():
            yield f"{path} is missing"
        elif path.stat().st_size != facts["bytes"]:
            yield f"{path} has {path.stat().st_size} bytes, expected {facts['bytes']}"
        elif digest_file(path) != facts["sha256"]:
            yield f"{path} was changed"


def _verify_objects(shards: Shards) -> Iterator[str]:
    columns = ("id", "geometry", "package", "shard", "offset", "size", "shared")
    table = shards.manifest(*columns).to_pydict()
    rows = {name: {key: table[key][row] for key in columns} for row, name in enumerate(table["id"])}
    if len(rows) != len(table["id"]):
        yield f"{shards.folder}: the manifest names {len(table['id']) - len(rows)} objects twice"
    if len(rows) != len(shards):
        yield f"{shards.folder}: the manifest has {len(rows)} objects, dataset.json states {len(shards)}"
    found: dict[str, str] = {}
    geometry: dict[str, str] = {}
    for item in tqdm(shards, "verified", unit="object", disable=None):
        if item.id in found:
            yield f"{item.id}: is in the shards twice"
        row = rows.get(item.id)
        if row is None:
            yield f"{item.id}: is in a shard, not in the manifest"
            continue
        try:
            sample = item.sample
            yield from _verify_object(item, sample, row)
        except PackingError as error:
            yield f"{item.id}: {error}"
            continue
        if shards[item.id].members != item.members:
            yield f"{item.id}: the manifest gives another position in {row['shard']}"
        if sample.geometry in geometry:
            yield f"{item.id}: has the geometry of {geometry[sample.geometry]}"
        geometry[sample.geometry] = item.id
        found[item.id] = item.id
    for name in rows.keys() - found.keys():
        yield f"{name}: is in the manifest, not readable in a shard"
    used = {one for row in rows.values() for one in row["shared"]}
    for sha256 in sorted(used ^ shards.shared_places.keys()):
        yield f"{SHARED_INDEX}: {sha256} is {'missing' if sha256 in used else 'used by no object'}"


def _verify_object(item: StoredObject, sample: Sample, row: dict[str, object]) -> Iterator[str]:
    """Problems of a package that differs from its sample or its row."""
    files = item.files()
    listing = files.get(LISTING, b"")
    if sample.id != item.id:
        yield f"{item.id}: its JSON is that of {sample.id}"
    if digest(listing) != sample.package or sample.package != row["package"]:
        yield f"{item.id}: the files of the package are not those that were packed"
    if sample.geometry != row["geometry"]:
        yield f"{item.id}: sample and manifest have different geometry"
    if len(files) != sample.files or sum(map(len, files.values())) != sample.unpacked_bytes:
        yield f"{item.id}: {len(files)} files, expected {sample.files} of {sample.unpacked_bytes} bytes"
