"""Reads a GLB, glTF or OBJ with named nodes as a mechanism, with the joints of a file beside it."""

from pathlib import Path

import numpy as np

from artigen.datasets.joints_file import BODY, JointsFile, NodeJoint, joints_path, read_joints
from artigen.datasets.mechanism import Mechanism, Solid, make_mechanism
from artigen.datasets.mesh_files import read_named
from artigen.datasets.part_labels import SPLIT_WORDS, find_word
from artigen.errors import SourceError, list_some
from artigen.files.urdf import UrdfJoint
from artigen.transforms import shift

SUFFIXES = (".glb", ".gltf", ".obj")


def read_mesh_scene(path: Path) -> Mechanism:
    """Reads one object of a mesh file, with its joints.

    Raises:
        SourceError: If the file or its joints cannot be read, or a joint names a node that is not there.
    """
    place = joints_path(path)
    if not place.is_file():
        raise SourceError(
            f"{path}: its joints are looked for in {place.name}, which is not there: "
            f"`artigen convert {path.name} --suggest-joints` writes one to be confirmed"
        )
    return join_nodes(path, read_joints(place))


def join_nodes(path: Path, said: JointsFile) -> Mechanism:
    """The nodes of a mesh file as the links of a mechanism, in metres.

    Raises:
        SourceError: As `read_mesh_scene`.
    """
    named, missing = read_named(path, path.parent)
    nodes = {node: joint.part for joint in said.joints for node in joint.nodes}
    met = {name for names, _ in named for name in names}
    gone = [node for node in nodes if node not in met]
    if gone:
        raise SourceError(
            f"{joints_path(path)}: node {gone[0]!r} is not in {path.name}, which has {list_some(sorted(met))}"
        )
    origins = {joint.part: said.metres * np.array(joint.origin) for joint in said.joints} | {
        BODY: np.zeros(3)
    }
    solids = []
    for names, mesh in named:
        part = next((nodes[name] for name in names if name in nodes), BODY)
        T = shift(-origins[part]) @ np.diag([said.metres, said.metres, said.metres, 1.0])
        split = (name for name in names if find_word(name) in SPLIT_WORDS)
        name = next(split, (*names, part)[0])
        solids.append(Solid(link=part, name=name, T_link_shape=np.eye(4), pieces=(mesh.apply_transform(T),)))
    return make_mechanism(
        path,
        path.stem,
        [BODY, *(joint.part for joint in said.joints)],
        [_make_joint(joint, origins, said.metres) for joint in said.joints],
        visuals=solids,
        notes=[f"images and materials that are missing: {', '.join(missing)}"] if missing else [],
        labels={joint.part: joint.label for joint in said.joints},
        frame=(said.up, said.front),
    )


def _make_joint(joint: NodeJoint, origins: dict[str, np.ndarray], metres: float) -> UrdfJoint:
    unit, limited = metres if joint.type == "prismatic" else 1.0, joint.type in ("revolute", "prismatic")
    return UrdfJoint(
        name=joint.part,
        type=joint.type,
        parent=joint.parent,
        child=joint.part,
        T_parent_joint=shift(origins[joint.part] - origins[joint.parent]),
        axis=np.array(joint.axis),
        lower=unit * joint.lower if limited else None,
        upper=unit * joint.upper if limited else None,
        mimic=joint.mimic,
        mimic_multiplier=joint.multiplier,
        mimic_offset=0.0,
    )
