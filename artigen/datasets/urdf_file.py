"""URDFs of sources: a file that is one tree of known joints and shapes with finite numbers, or an error."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from artigen.datasets.mechanism import JOINT_TYPES, Mechanism, make_mechanism
from artigen.datasets.xacro_file import SUFFIX, expand_xacro
from artigen.errors import SourceError
from artigen.files.urdf import UrdfFile, is_xacro, parse_urdf, tree_problems


def read_urdf(path: Path, arguments: Sequence[str] = ()) -> Mechanism:
    """Reads links, joints and shapes of one URDF, or of the URDF that a xacro stands for.

    Args:
        arguments: ``name:=value`` for each argument of a xacro.

    Raises:
        SourceError: If the file is invalid; names the element and its value.
    """
    text = expand_xacro(path, arguments) if path.suffix.lower() == SUFFIX or is_xacro(path) else None
    urdf = parse_urdf(path, inertials=False, text=text)
    problem = next(_find_problems(urdf), None)
    if problem is not None:
        raise SourceError(f"{path}: {problem}")
    return make_mechanism(
        path,
        urdf.name,
        (link.name for link in urdf.links),
        urdf.joints,
        visuals=(shape for link in urdf.links for shape in link.visuals),
        collisions=(shape for link in urdf.links for shape in link.collisions),
    )


def _find_problems(urdf: UrdfFile) -> Iterator[str]:
    """Reasons why a file cannot be converted, a sentence each."""
    yield from (sentence for _, sentence in tree_problems(urdf))
    joints = {joint.name for joint in urdf.joints}
    for joint in urdf.joints:
        where = f"joint {joint.name!r}"
        if joint.type not in JOINT_TYPES:
            yield f"{where}: type {joint.type!r} is not one of {', '.join(JOINT_TYPES)}"
        if joint.mimic is not None and joint.mimic not in joints:
            yield f"{where}: mimics joint {joint.mimic!r}, which does not exist"
        numbers = [*joint.T_parent_joint.ravel(), *joint.axis, joint.mimic_multiplier, joint.mimic_offset]
        if not np.isfinite(numbers).all():
            yield f"{where}: origin, axis or mimic holds numbers that are not finite"
        if np.isnan([joint.lower or 0.0, joint.upper or 0.0]).any():
            yield f"{where}: limits [{joint.lower}, {joint.upper}], expected numbers"
    for link in urdf.links:
        for shape in (*link.visuals, *link.collisions):
            where = f"shape {shape.name!r} of link {link.name!r}"
            if shape.kind == "mesh" and not shape.file:
                yield f"{where}: a <mesh> lacks its 'filename'"
            if not np.isfinite([*shape.T_link_shape.ravel(), *shape.sizes, *shape.scale]).all():
                yield f"{where}: origin, size or scale holds numbers that are not finite"
            if min(shape.sizes, default=1.0) <= 0.0:
                yield f"{where}: {shape.kind} {list(shape.sizes)} has no extent, expected lengths above 0"
