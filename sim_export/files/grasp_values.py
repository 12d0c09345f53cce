"""Grasps in ``annotations.json``."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from artigen.transforms import matrix_from_quat, quat_from_matrix
from sim_export.errors import PackageError
from sim_export.files.rounding import number, rounded
from sim_export.files.urdf import link_origins
from sim_export.package import WHOLE, Grasp, Proof, SimPackage

GRASPS_VERSION = 1
"""Version of the schema."""


def grasps_value(package: SimPackage) -> dict:
    """Grasps with their poses in the frames of their links."""
    origins = link_origins(package)
    rows = [
        {
            "link": grasp.link,
            "part": grasp.part,
            "joint": grasp.joint,
            "gripper": grasp.gripper,
            "position": rounded(grasp.pose[:3, 3] - origins[grasp.link]),
            "quaternion": rounded(quat_from_matrix(grasp.pose[:3, :3])),
            "width": number(grasp.width, 6),
            "score": number(grasp.score, 4),
            "stroke": rounded(np.array(grasp.stroke)),
            "proofs": [
                {"engine": proof.engine, "opened": number(proof.opened, 4), "held": proof.held}
                for proof in grasp.proofs
            ],
        }
        for grasp in package.grasps
    ]
    return {"version": GRASPS_VERSION, "frame": "link, metres; z approaches, y closes", "grasps": rows}


def grasps_from_json(value: dict, poses: Mapping[str, Float[np.ndarray, "4 4"]]) -> tuple[Grasp, ...]:
    """Parses the grasps of a file of annotations.

    Args:
        value: The file.
        poses: Pose of every link in the object frame at rest.
    """
    stored = value.get("grasps", {"version": GRASPS_VERSION, "grasps": []})
    try:
        if stored["version"] != GRASPS_VERSION:
            raise PackageError(
                f"annotations.json: grasps of version {stored['version']}, this reads {GRASPS_VERSION}"
            )
        return tuple(
            Grasp(
                link=entry["link"],
                part=entry["part"],
                joint=entry["joint"],
                gripper=entry["gripper"],
                pose=poses[entry["link"]] @ _pose(entry["position"], entry["quaternion"]),
                width=float(entry["width"]),
                score=float(entry["score"]),
                stroke=_stroke(entry.get("stroke", WHOLE)),
                proofs=tuple(
                    Proof(engine=proof["engine"], opened=float(proof["opened"]), held=bool(proof["held"]))
                    for proof in entry["proofs"]
                ),
            )
            for entry in stored["grasps"]
        )
    except (KeyError, TypeError, ValueError) as err:
        raise PackageError(f"annotations.json: grasps do not have the expected structure ({err!r})") from err


def _stroke(value: list) -> tuple[float, float]:
    begin, end = value
    return float(begin), float(end)


def _pose(position: list, quaternion: list) -> Float[np.ndarray, "4 4"]:
    T = np.eye(4)
    T[:3, :3] = matrix_from_quat(np.array(quaternion, dtype=np.float64).reshape(4))
    T[:3, 3] = position
    return T
