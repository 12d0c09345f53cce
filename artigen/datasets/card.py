"""The card of a data set: README.md as Hugging Face reads it, with statistics and a picture."""

import io
from collections import Counter
from collections.abc import Mapping, Sequence
from importlib.resources import files
from string import Template
from typing import Any

import numpy as np

from artigen.datasets.manifest import MANIFEST, About
from artigen.datasets.packing import need

SIZES = (
    (1_000, "n<1K"),
    (10_000, "1K<n<10K"),
    (100_000, "10K<n<100K"),
    (1_000_000, "100K<n<1M"),
    (10_000_000, "1M<n<10M"),
)
"""Hugging Face's words for numbers of examples below a bound."""
TAGS = ("articulated-objects", "simulation", "robotics", "urdf", "mjcf", "mujoco", "sapien", "maniskill",
        "3d", "synthetic", "webdataset")  # fmt: skip
LABELS = ("drawers", "doors", "handles", "knobs", "trays", "shelves", "wheels")
COLUMNS = ("id", "category", "source", "topology", "depth", "width", "height", "mass", "joint_kinds", *LABELS,
           "handle_annotations", "links", "hulls", "triangles", "passed", "checks_passed", "files",
           "unpacked_bytes")  # fmt: skip
"""Columns of the manifest used for statistics."""
HEADINGS = ("category", "objects", "by the model", "topologies", "joints", "handles", "width (m)",
            "depth (m)", "height (m)", "mass (kg)")  # fmt: skip
CHECKED = """files and units; closed meshes, convex hulls, collision true to the visual; sweeps of every
joint without collision, opening directions, handles; and, in SAPIEN, that it stands, opens and closes by
hand, stays shut when tilted and repeats exactly. Values and thresholds are in each package's
`validation.json`."""
Table = Mapping[str, list[Any]]
Files = Mapping[str, Mapping[str, Any]]


def draw_sheet(thumbnails: Sequence[bytes], columns: int) -> bytes:
    """Thumbnails of one size in rows, as WebP; the last row is padded with the colour of a corner."""
    from PIL import Image

    images = [np.asarray(Image.open(io.BytesIO(data)).convert("RGB")) for data in thumbnails]
    columns = min(columns, len(images))
    blank = np.broadcast_to(images[0][0, 0], images[0].shape)
    images += [blank] * (-len(images) % columns)
    rows = [np.concatenate(images[at : at + columns], axis=1) for at in range(0, len(images), columns)]
    stream = io.BytesIO()
    Image.fromarray(np.concatenate(rows, axis=0)).save(stream, "WEBP", quality=85, method=4)
    return stream.getvalue()


def card_text(table: Table, stored: Files, about: About, *, example: str, sheet: str, shown: int) -> str:
    """README.md of a data set.

    Args:
        table: `COLUMNS` of its manifest.
        stored: Size of every file by path, under ``bytes``.
    """
    count = len(table["id"])
    kinds = Counter(kind for row in table["joint_kinds"] for kind in row)
    counts = {label: sum(table[label]) for label in LABELS}
    drawn = sum(one == "model" for one in table["source"])
    described = about.description.strip()
    values = {
        "header": _header(about, count),
        "title": about.title or about.name,
        "name": about.name,
        "description": f"{described}\n\n" if described else "",
        "objects": f"{count:,}",
        "categories": len(set(table["category"])),
        "joints": f"{kinds.total():,}",
        "joint_kinds": ", ".join(f"{number:,} {kind}" for kind, number in kinds.most_common()),
        "handles": f"{sum(table['handle_annotations']):,}",
        "kilobytes": f"{sum(one['bytes'] for one in stored.values()) / count / 1000:.0f}",
        "sheet": sheet,
        "shown": shown,
        "contents": _contents(table),
        "parts": ", ".join(f"{number:,} {label}" for label, number in counts.items() if number),
        "links": _spread(table["links"], 0),
        "hulls": _spread(table["hulls"], 0),
        "triangles": _spread(table["triangles"], 0),
        "files_each": _spread(table["files"], 0),
        "checks": _checks(about, table),
        "duplicates": _duplicates(about),
        "first": table["id"][0],
        "example": example,
        "unpacked": f"{sum(table['unpacked_bytes']) / 1e6:,.0f}",
        "generator": about.generator,
        "recipes": ", ".join(f"`recipes/{name}`" for name, _ in about.recipes),
        "model": f", {drawn:,} of them by a sketch network that was trained on objects of that grammar"
        if drawn
        else "",
        "license": about.license,
        "size_manifest": _total(stored, MANIFEST),
        "size_shards": _total(stored, "shards/"),
        "size_shared": _total(stored, "shared"),
        "size_example": _total(stored, f"{example}/"),
        "size_images": _total(stored, "images/"),
    }
    return Template(files("artigen.datasets").joinpath("card.md").read_text()).substitute(values)


def _header(about: About, count: int) -> str:
    value = {
        "pretty_name": about.title or about.name,
        "license": about.license,
        "task_categories": ["robotics"],
        "tags": list(TAGS),
        "size_categories": [next((word for bound, word in SIZES if count < bound), "n>10M")],
        "annotations_creators": ["machine-generated"],
        "source_datasets": ["original"],
        "configs": [{"config_name": "objects", "default": True, "data_files": MANIFEST}],
    }
    return need("yaml").safe_dump(value, sort_keys=False, allow_unicode=True)


def _contents(table: Table) -> str:
    lines = [_line(HEADINGS), _line(["---"] * len(HEADINGS))]
    categories = np.array(table["category"])
    for name in [*sorted(set(table["category"])), "all"]:
        rows = np.flatnonzero((categories == name) | (name == "all"))
        chosen = {key: [table[key][row] for row in rows] for key in COLUMNS}
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
        lines.append(_line(cells))
    return "\n".join(lines)


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _spread(values: Sequence[float], digits: int) -> str:
    low, middle, high = np.percentile(np.array(values, float), [5, 50, 95])
    return f"{middle:,.{digits}f} ({low:,.{digits}f} to {high:,.{digits}f})"


def _checks(about: About, table: Table) -> str:
    passed, count = sum(bool(one) for one in table["passed"]), len(table["id"])
    if all(one is None for one in table["passed"]):
        return "The objects of this data set were not tried; `artigen validate` does that."
    failed = (
        f" {len(about.failures):,} other objects that were drawn failed a check and were replaced."
        if about.failures
        else ""
    )
    return (
        f"{passed:,} of {count:,} objects ({100 * passed / count:.4g} %) passed every check that applies, "
        f"{_spread(table['checks_passed'], 0)} checks each:\n{CHECKED}{failed}"
    )


def _duplicates(about: About) -> str:
    near = (
        f", and objects with at most {100 * about.near:g} % of their surface in different places,"
        if about.near
        else ""
    )
    return (
        f"Objects of equal geometry{near} count as duplicates: {len(about.duplicates):,} were left out\n"
        "(`dataset.json` lists them)."
    )


def _total(stored: Files, start: str) -> str:
    found = [one["bytes"] for name, one in stored.items() if name.startswith(start)]
    return f"{len(found):,} | {sum(found) / 1e6:,.2f}"
