"""The card of a data set: README.md as Hugging Face reads it, with statistics and a picture."""

import io
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from artigen.datasets.extra import need
from artigen.datasets.manifest import MANIFEST

if TYPE_CHECKING:
    from artigen.datasets.publish import About
    from artigen.datasets.shards import Shards

SIZES = (
    (1_000, "n<1K"),
    (10_000, "1K<n<10K"),
    (100_000, "10K<n<100K"),
    (1_000_000, "100K<n<1M"),
    (10_000_000, "1M<n<10M"),
)
"""Hugging Face's words for numbers of examples below a bound."""
TAGS = (
    "articulated-objects",
    "simulation",
    "robotics",
    "urdf",
    "mjcf",
    "mujoco",
    "sapien",
    "maniskill",
    "3d",
    "synthetic",
    "webdataset",
)
READ = ("id", "category", "source", "topology", "depth", "width", "height", "mass", "joint_kinds", "drawers",
        "doors", "handles", "knobs", "wheels", "trays", "shelves", "handle_annotations", "links", "hulls",
        "triangles", "passed", "checks_passed", "files", "unpacked_bytes", "packed_bytes", "size",
        "draws")  # fmt: skip
"""Columns of the manifest that statistics are made of."""
MEANINGS: Mapping[str, str] = {
    "id": "name of the object; key of its sample",
    "category": "what it is",
    "source": "`grammar` (procedural) or `model` (drawn by a trained network)",
    "seed, style": "with the recipe, what it was drawn from",
    "generator, model, draws": "program and version; hash of the weights; how often it was drawn until it passed",
    "topology": "equal for objects with the same links, joints and kinds of collision shapes, which fit in one "
    "batch of an engine",
    "depth, width, height": "metres along x, y, z of the closed object",
    "mass": "kilograms",
    "drawers ... shelves": "number of parts by label",
    "joint_kinds": "kind of every joint that can be driven",
    "handle_annotations": "number of annotated handles",
    "links, hulls, triangles": "rigid bodies, convex collision shapes, visual triangles",
    "passed, checks_passed, checks_failed, checks_not_applicable": "verdict of all checks; how many were passed; "
    "which were not, or did not apply",
    "geometry": "SHA-256 of the geometry; no two objects have the same",
    "package": "SHA-256 of the package's `manifest.json`, which lists the SHA-256 of its files",
    "files, unpacked_bytes, packed_bytes": "of the package, unpacked, and of its archive",
    "shared": "SHA-256 of the images that it shares with others",
    "shard, offset, size": "where its sample lies: bytes `offset` to `offset + size` of `shards/shard`",
    "thumbnail": "closed and open, WebP",
    "descriptor": "where its surface is: 2 x 8 x 8 x 8 shares (uint16) of what is fixed and what moves",
}


def size_category(count: int) -> str:
    """Hugging Face's word for a number of examples."""
    return next((word for bound, word in SIZES if count < bound), "n>10M")


def draw_sheet(thumbnails: Sequence[bytes], columns: int) -> bytes:
    """Thumbnails of one size in rows, as WebP; the last row is filled up with the corner's colour."""
    from PIL import Image

    images = [np.asarray(Image.open(io.BytesIO(data)).convert("RGB")) for data in thumbnails]
    columns = min(columns, len(images))
    blank = np.broadcast_to(images[0][0, 0], images[0].shape)
    images += [blank] * (-len(images) % columns)
    rows = [np.concatenate(images[at : at + columns], axis=1) for at in range(0, len(images), columns)]
    stream = io.BytesIO()
    Image.fromarray(np.concatenate(rows, axis=0)).save(stream, "WEBP", quality=85, method=4)
    return stream.getvalue()


def card_text(shards: "Shards", about: "About", example: str, sheet: str) -> str:
    """README.md of a data set."""
    table = shards.manifest(*READ).to_pydict()
    parts = [
        _header(about, len(shards)),
        _introduction(about, table, sheet),
        _contents(table),
        _proof(about, table),
        _loading(about, table),
        _layout(shards, table, example),
        _fields(),
        _origin(about, table),
    ]
    return "\n".join(parts)


def _header(about: "About", count: int) -> str:
    value = {
        "pretty_name": about.title or about.name,
        "license": about.license,
        "task_categories": ["robotics"],
        "tags": list(TAGS),
        "size_categories": [size_category(count)],
        "annotations_creators": ["machine-generated"],
        "source_datasets": ["original"],
        "configs": [{"config_name": "objects", "default": True, "data_files": MANIFEST}],
    }
    return f"---\n{need('yaml').safe_dump(value, sort_keys=False, allow_unicode=True)}---\n"


def _introduction(about: "About", table: Mapping[str, list[Any]], sheet: str) -> str:
    count = len(table["id"])
    kinds = Counter(kind for row in table["joint_kinds"] for kind in row)
    said = ", ".join(f"{number:,} {kind}" for kind, number in kinds.most_common())
    described = f"{about.description.strip()}\n\n" if about.description.strip() else ""
    mean = sum(table["size"]) / count / 1000
    return (
        f"# {about.title or about.name}\n\n{described}"
        f"{count:,} articulated objects of {len(set(table['category']))} categories for robot simulation, with "
        f"{sum(kinds.values()):,} joints ({said}) and {sum(table['handle_annotations']):,} annotated handles. "
        "Every object is a package that loads in SAPIEN, ManiSkill, MuJoCo and other readers of URDF: closed "
        "visual meshes with textures, convex collision shapes that keep drawers and compartments open, mass and "
        f"inertia, joint friction in SI units. A sample takes {mean:.0f} kB.\n\n"
        f"![objects of the data set, each closed and open]({sheet})\n\n"
        f"The first {min(count, 48)} objects of the first shard, closed and open; nothing is picked.\n"
    )


def _contents(table: Mapping[str, list[Any]]) -> str:
    lines = [
        "## Objects\n",
        "| category | objects | of them by the model | topologies | joints | handles | width (m) | depth (m) | "
        "height (m) | mass (kg) |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    categories = np.array(table["category"])
    for name in [*sorted(set(table["category"])), "all"]:
        rows = np.flatnonzero((categories == name) | (name == "all"))
        chosen = {key: [table[key][row] for row in rows] for key in READ}
        cells = [
            f"**{name}**" if name == "all" else name,
            f"{len(rows):,}",
            f"{sum(one == 'model' for one in chosen['source']):,}",
            f"{len(set(chosen['topology'])):,}",
            _spread([len(one) for one in chosen["joint_kinds"]], 0),
            _spread(chosen["handle_annotations"], 0),
            *(_spread(chosen[key], 2) for key in ("width", "depth", "height")),
            _spread(chosen["mass"], 0),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    labels = ("drawers", "doors", "handles", "knobs", "trays", "shelves", "wheels")
    counts = ", ".join(f"{sum(table[label]):,} {label}" for label in labels if sum(table[label]))
    lines.append("\nMedian (5 % to 95 %).\n")
    lines.append(
        f"Together they have {counts}. Per object, median (5 % to 95 %): {_spread(table['links'], 0)} links, "
        f"{_spread(table['hulls'], 0)} collision shapes, {_spread(table['triangles'], 0)} visual triangles, "
        f"{_spread(table['files'], 0)} files.\n"
    )
    return "\n".join(lines)


def _spread(values: Sequence[float], digits: int) -> str:
    low, middle, high = np.percentile(np.array(values, float), [5, 50, 95])
    return f"{middle:,.{digits}f} ({low:,.{digits}f} to {high:,.{digits}f})"


def _proof(about: "About", table: Mapping[str, list[Any]]) -> str:
    passed, count = sum(bool(one) for one in table["passed"]), len(table["id"])
    tried = sum(one is not None for one in table["passed"])
    text = "## Checks\n\n"
    if tried:
        text += (
            f"{passed:,} of {count:,} objects ({100 * passed / count:.4g} %) passed every check that applies, "
            f"{_spread(table['checks_passed'], 0)} checks each: files and units; closed meshes, convex hulls, "
            "collision true to the visual; sweeps of every joint without collision, opening directions, "
            "handles; and in SAPIEN, that it stands, opens and closes by hand, stays shut when tilted and "
            "repeats exactly. Values and thresholds are in `validation.json` of each package.\n"
        )
    else:
        text += "The objects of this data set were not tried; `artigen validate` does that.\n"
    if about.failures:
        text += f"\n{len(about.failures):,} other objects were drawn, failed a check and are not here.\n"
    rule = (
        f" and objects with at most {100 * about.near:g} % of their surface in different places"
        if about.near
        else ""
    )
    text += (
        f"\nObjects of equal geometry{rule} count as duplicates: {len(about.duplicates):,} were left out "
        "(`dataset.json` lists them).\n"
    )
    return text


def _loading(about: "About", table: Mapping[str, list[Any]]) -> str:
    name = table["id"][0]
    return f"""## How to load

The manifest, a row per object with its thumbnail, by Hugging Face's `datasets`:

```python
from datasets import load_dataset

objects = load_dataset("PATH/TO/{about.name}", split="train")
drawers = objects.filter(lambda row: row["drawers"] >= 2)
```

The samples, streamed:

```python
from datasets import load_dataset

samples = load_dataset("webdataset", data_files="PATH/TO/{about.name}/shards/*.tar", split="train", streaming=True)
for sample in samples:
    print(sample["__key__"], [joint["kind"] for joint in sample["json"]["joints"]])
```

Whole packages, by artigen (`pip install "artigen[dataset]"`), streamed or by id:

```python
from artigen.datasets import open_shards

shards = open_shards("PATH/TO/{about.name}")
for item in shards:
    files = item.files()  # path -> bytes: mobility.urdf, mobility.mjcf.xml, meshes, textures, annotations
shards["{name}"].unpack("out/{name}")  # a folder that simulators load
```

Without artigen: a sample's `.tar.zst` is a tar of its own files, compressed with zstd; `shared` in its `.json` names
the images that belong to it by path and SHA-256, which `shared.parquet` finds in `shared/*.tar`.
"""


def _layout(shards: "Shards", table: Mapping[str, list[Any]], example: str) -> str:
    files: Mapping[str, Mapping[str, Any]] = shards.index["files"]

    def total(start: str) -> str:
        found = [one["bytes"] for name, one in files.items() if name.startswith(start)]
        return f"{len(found):,} files, {sum(found) / 1e6:,.2f} MB"

    whole = sum(table["unpacked_bytes"]) / 1e6
    return f"""## Files

| what | holds | size |
|---|---|---|
| `manifest.parquet` | a row per object | {total("manifest.parquet")} |
| `shards/*.tar` | WebDataset: `ID.json` (joints, handles, counts, verdict), `ID.tar.zst` (files of the package), \
`ID.webp` (thumbnail) | {total("shards/")} |
| `shared/*.tar`, `shared.parquet` | images that objects share, named after their SHA-256, and where they lie | \
{total("shared")} |
| `{example}/` | the first object unpacked | {total(example)} |
| `croissant.json` | Croissant metadata | |
| `dataset.json` | size and SHA-256 of every file; what was left out | |
| `recipes/` | what was asked for | |

Unpacked, the packages take {whole:,.0f} MB.
"""


def _fields() -> str:
    lines = ["## Columns of the manifest\n", "| column | what |", "|---|---|"]
    lines += [f"| {name} | {meaning} |" for name, meaning in MEANINGS.items()]
    return "\n".join(lines) + "\n"


def _origin(about: "About", table: Mapping[str, list[Any]]) -> str:
    recipes = ", ".join(f"`recipes/{name}`" for name, _ in about.recipes)
    drawn = sum(one == "model" for one in table["source"])
    model = f"; {drawn:,} by its sketch network, trained on objects of that grammar" if drawn else ""
    return f"""## Where it comes from

Made by {about.generator} from {recipes}: objects are drawn from a procedural grammar of furniture and \
appliances{model}. No scans, photos or meshes of others went in. The same recipe and version give the same bytes.

Sizes and proportions follow furniture as it is sold; masses follow from wall volume and handbook densities, friction
from handbook values, none of them from measurements. Frame: z up, the front faces -x, metres, `q = 0` is closed.

Licence of the data: {about.license}.
"""
