"""Croissant metadata (version 1.0) of a data set: its files, and the columns of the manifest."""

import json
from collections.abc import Mapping
from typing import Any

from artigen.datasets.manifest import COLUMNS, MANIFEST, About

CONFORMS = "http://mlcommons.org/croissant/1.0"
CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "citeAs": "cr:citeAs",
    "column": "cr:column",
    "conformsTo": "dct:conformsTo",
    "cr": "http://mlcommons.org/croissant/",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "dct": "http://purl.org/dc/terms/",
    "equivalentProperty": "cr:equivalentProperty",
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "extract": "cr:extract",
    "field": "cr:field",
    "fileObject": "cr:fileObject",
    "fileProperty": "cr:fileProperty",
    "fileSet": "cr:fileSet",
    "format": "cr:format",
    "includes": "cr:includes",
    "isLiveDataset": "cr:isLiveDataset",
    "jsonPath": "cr:jsonPath",
    "key": "cr:key",
    "md5": "cr:md5",
    "parentField": "cr:parentField",
    "path": "cr:path",
    "recordSet": "cr:recordSet",
    "references": "cr:references",
    "regex": "cr:regex",
    "repeated": "cr:repeated",
    "replace": "cr:replace",
    "samplingRate": "cr:samplingRate",
    "sc": "https://schema.org/",
    "separator": "cr:separator",
    "source": "cr:source",
    "subField": "cr:subField",
    "transform": "cr:transform",
}
"""The JSON-LD context of Croissant 1.0."""
TYPES = {
    "string": "sc:Text",
    "list<string>": "sc:Text",
    "int32": "sc:Integer",
    "int64": "sc:Integer",
    "float64": "sc:Float",
    "bool": "sc:Boolean",
}
"""Croissant's types of columns; images and bytes inside a table have none."""
LICENSES = {
    "cc-by-4.0": "https://creativecommons.org/licenses/by/4.0/",
    "cc-by-sa-4.0": "https://creativecommons.org/licenses/by-sa/4.0/",
    "cc-by-nc-4.0": "https://creativecommons.org/licenses/by-nc/4.0/",
    "cc0-1.0": "https://creativecommons.org/publicdomain/zero/1.0/",
    "apache-2.0": "https://www.apache.org/licenses/LICENSE-2.0",
    "mit": "https://opensource.org/license/mit/",
}


def croissant_text(count: int, stored: Mapping[str, Mapping[str, Any]], about: About) -> str:
    """croissant.json of a data set.

    Args:
        stored: Size and SHA-256 of every file by its path, which is relative to croissant.json.
    """
    value: dict[str, Any] = {
        "@context": CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": CONFORMS,
        "name": about.name,
        "description": about.description.strip() or f"{count} articulated objects for simulation.",
        "license": LICENSES.get(about.license, about.license),
        "version": "1.0.0",
        "keywords": ["articulated objects", "robotics", "simulation", "URDF", "MJCF"],
        "creator": {"@type": "sc:Organization", "name": about.creator},
    }
    if about.url:
        value["url"] = about.url
    if about.date:
        value["datePublished"] = about.date
    value["distribution"] = [
        _file(name, facts)
        for name, facts in stored.items()
        if name == MANIFEST or name.endswith(".tar") or name == "shared.parquet"
    ]
    value["recordSet"] = [_records()]
    return json.dumps(value, indent=1, ensure_ascii=False) + "\n"


def _file(name: str, facts: Mapping[str, Any]) -> dict[str, Any]:
    parquet = name.endswith(".parquet")
    return {
        "@type": "cr:FileObject",
        "@id": name,
        "name": name,
        "contentUrl": name,
        "contentSize": f"{facts['bytes']} B",
        "encodingFormat": "application/x-parquet" if parquet else "application/x-tar",
        "sha256": facts["sha256"],
    }


def _records() -> dict[str, Any]:
    fields = []
    for name, kind in COLUMNS.items():
        if kind not in TYPES:
            continue
        field: dict[str, Any] = {
            "@type": "cr:Field",
            "@id": f"objects/{name}",
            "name": name,
            "dataType": TYPES[kind],
            "source": {"fileObject": {"@id": MANIFEST}, "extract": {"column": name}},
        }
        if kind.startswith("list"):
            field["repeated"] = True
        fields.append(field)
    return {
        "@type": "cr:RecordSet",
        "@id": "objects",
        "name": "objects",
        "description": "A row per object.",
        "key": {"@id": "objects/id"},
        "field": fields,
    }
