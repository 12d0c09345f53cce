"""Grasps of packages in the formats of others: ACRONYM's HDF5, Isaac's YAML, and one table as CSV.

- ACRONYM (Eppner et al. 2021, github.com/NVlabs/acronym): ``grasps/transforms [N 4 4]`` in the frame of
  ``object/file``, ``grasps/qualities/flex/object_in_gripper [N]``. Its gripper frame is that of the hand, in
  which the fingers close along x. Ours adds links, widths, scores and strokes, for which it has no place.
- ``isaac_grasp`` 1.0 (docs.isaacsim.omniverse.nvidia.com, Grasp Editor): one file per gripper and body, which
  is a link here. Its gripper frame is that of the hand, and ``cspace_position`` the finger joint.
"""

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from artigen.transforms import quat_from_matrix, shift
from sim_export.files.urdf import link_origins
from sim_export.grasps.gripper import find_gripper
from sim_export.package import Grasp, SimPackage

COLUMNS = (
    "package", "link", "part", "joint", "gripper", "x", "y", "z", "qw", "qx", "qy", "qz",
    "width", "score", "begin", "end", "proven", "proofs",
)  # fmt: skip
"""Columns of the table; poses are in the link's frame, metres, and quaternions wxyz. ``begin`` and ``end``
are the grasp's stroke."""
T_OURS_ACRONYM = np.array([[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0, 0, 0, 1.0]])
"""Turns ACRONYM's x, along which its fingers close, to our y."""


def hand_pose(grasp: Grasp) -> Float[np.ndarray, "4 4"]:
    """Pose of the frame of the hand, which lies behind ours, in the object frame at rest."""
    return grasp.pose @ shift(np.array([0.0, 0.0, -find_gripper(grasp.gripper).base]))


def write_acronym(package: SimPackage, grasps: Sequence[Grasp], mesh: str, path: Path) -> None:
    """Writes grasps of one gripper as HDF5 in the layout of ACRONYM, in the object frame at rest.

    Args:
        mesh: Name of the file with the closed object.
    """
    import h5py

    poses = np.array([hand_pose(grasp) @ T_OURS_ACRONYM for grasp in grasps]).reshape(-1, 4, 4)
    masses = [link.inertial for link in package.links if link.inertial is not None]
    total = sum(each.mass for each in masses)
    with h5py.File(path, "w") as file:
        file["object/file"], file["object/scale"] = mesh, 1.0
        file["object/mass"] = total
        file["object/com"] = sum((each.mass * each.com for each in masses), np.zeros(3)) / max(total, 1e-9)
        file["gripper/type"] = grasps[0].gripper if grasps else ""
        file["grasps/transforms"] = poses
        file["grasps/qualities/flex/object_in_gripper"] = np.array([x.proven for x in grasps], np.int64)
        file["grasps/width"] = np.array([grasp.width for grasp in grasps])
        file["grasps/stroke"] = np.array([grasp.stroke for grasp in grasps])
        file["grasps/score"] = np.array([grasp.score for grasp in grasps])
        for name in ("link", "part", "joint"):
            file[f"grasps/{name}"] = np.array([getattr(x, name) for x in grasps], dtype=h5py.string_dtype())


def isaac_text(package: SimPackage, link: str, grasps: Sequence[Grasp]) -> str:
    """Grasps of one gripper on one link as an ``isaac_grasp`` file; those not proven have no confidence."""
    origin, gripper = link_origins(package)[link], find_gripper(grasps[0].gripper)
    lines = [
        "format: isaac_grasp",
        "format_version: 1.0",
        "",
        f"object_frame_link: {json.dumps(link)}",
        f"gripper_frame_link: {json.dumps(gripper.name)}",
        "",
        "grasps:",
    ]
    for number, grasp in enumerate(grasps):
        T = hand_pose(grasp)
        w, *xyz = _numbers(quat_from_matrix(T[:3, :3]))
        opened = min(gripper.opening, grasp.width + 0.02)
        lines += [
            f"  grasp_{number}:",
            f"    confidence: {grasp.score if grasp.proven else 0.0:.4f}",
            f"    position: {_numbers(T[:3, 3] - origin)}",
            f"    orientation: {{w: {w}, xyz: {xyz}}}",
            f"    cspace_position: {{{gripper.joint}: {gripper.coordinate(grasp.width):.6f}}}",
            f"    pregrasp_cspace_position: {{{gripper.joint}: {gripper.coordinate(opened):.6f}}}",
        ]
    return "\n".join(lines) + "\n"


def table_text(packages: Sequence[SimPackage]) -> str:
    """The grasps of many packages as CSV with `COLUMNS`."""
    out = io.StringIO()
    rows = csv.writer(out, lineterminator="\n")
    rows.writerow(COLUMNS)
    for package in packages:
        origins = link_origins(package)
        for grasp in package.grasps:
            place = _numbers(grasp.pose[:3, 3] - origins[grasp.link])
            turn = _numbers(quat_from_matrix(grasp.pose[:3, :3]))
            proofs = " ".join(f"{each.engine}:{each.opened:.3f}:{int(each.held)}" for each in grasp.proofs)
            rows.writerow([
                package.name, grasp.link, grasp.part, grasp.joint, grasp.gripper, *place, *turn,
                f"{grasp.width:.6f}", f"{grasp.score:.4f}", *_numbers(np.array(grasp.stroke)),
                int(grasp.proven), proofs,
            ])  # fmt: skip
    return out.getvalue()


def _numbers(values: Float[np.ndarray, "N"]) -> list[float]:
    return (np.round(values, 9) + 0.0).tolist()
