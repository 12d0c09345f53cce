"""Labelled pictures as a COCO data set: one annotation per visible part, with its amodal box beside.

The format is that of https://cocodataset.org/#format-data with uncompressed run lengths; keys that COCO does
not have (``amodal_bbox``, ``link``, ``part``, ``phrase``, ``joint``, ``camera``) are added.
"""

from typing import Any

import numpy as np
from jaxtyping import Bool

from artigen.types import PART_LABELS
from sim_export.picture.labelled import LabelledImage

OTHER = "part"
"""Category of parts without a label."""


def coco_categories() -> list[dict[str, Any]]:
    """The categories: part labels and `OTHER`, from 1."""
    names = (*PART_LABELS, OTHER)
    return [{"id": index + 1, "name": name, "supercategory": "part"} for index, name in enumerate(names)]


def coco_image(picture: LabelledImage, number: int, files: dict[str, str], **facts: Any) -> dict[str, Any]:
    """The entry of an image: its files, camera and joints, and further facts."""
    height, width = picture.parts.shape
    joints = [
        {
            "name": joint.name, "link": joint.link, "type": joint.type, "q": joint.q,
            "limits": [joint.lower, joint.upper], "origin": joint.origin.tolist(),
            "axis": joint.axis.tolist(),
        }
        for joint in picture.joints
    ]  # fmt: skip
    camera = {
        "intrinsics": picture.intrinsics.tolist(),
        "T_camera_object": picture.T_camera_object.tolist(),
    }
    return {
        "id": number,
        "width": width,
        "height": height,
        **files,
        **facts,
        "camera": camera,
        "joints": joints,
    }


def coco_annotations(
    picture: LabelledImage, image: int, first: int, phrases: dict[str, str]
) -> list[dict[str, Any]]:
    """One annotation for every part that is seen.

    Args:
        picture: The picture.
        image: Its id.
        first: Id of the first annotation.
        phrases: Phrases by link.
    """
    ids = {category["name"]: category["id"] for category in coco_categories()}
    found = []
    for index, part in enumerate(picture.shown):
        mask = picture.parts == index
        if not mask.any():
            continue
        rows, columns = np.nonzero(mask)
        left, top = int(columns.min()), int(rows.min())
        x0, y0, x1, y1 = part.amodal
        found.append(
            {
                "id": first + len(found),
                "image_id": image,
                "category_id": ids[part.label or OTHER],
                "bbox": [left, top, int(columns.max()) + 1 - left, int(rows.max()) + 1 - top],
                "area": int(mask.sum()),
                "iscrowd": 0,
                "segmentation": {"size": list(mask.shape), "counts": run_lengths(mask)},
                "amodal_bbox": [round(value, 2) for value in (x0, y0, x1 - x0, y1 - y0)],
                "link": part.link,
                "part": part.name,
                "phrase": phrases.get(part.link, ""),
            }
        )
    return found


def run_lengths(mask: Bool[np.ndarray, "H W"]) -> list[int]:
    """Lengths of runs of false and true, in turn, down the columns; the first is of false."""
    flat = mask.ravel(order="F")
    ends = np.flatnonzero(np.diff(flat)) + 1
    lengths = np.diff(np.concatenate([[0], ends, [len(flat)]])).tolist()
    return [0, *lengths] if flat[0] else lengths
