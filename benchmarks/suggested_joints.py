"""How often `artigen convert --suggest-joints` proposes the right joints, on objects of the grammar.

    python benchmarks/suggested_joints.py --count 3

Each object is written as an OBJ with an object per part, once with the names of its parts and once with
numbers. A part is right if its joint has the right type, its axis the right direction within 5 degrees, and a
hinge is within 5 % of the object's longest edge from the right one. What is fixed must not move by itself.
"""

import argparse
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

from artigen.datasets.joints_file import NodeJoint
from artigen.datasets.suggest_joints import suggest_joints
from artigen.errors import SourceError
from artigen.kind import kinds
from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape, ShapePart

DEGREES = 5.0
DISTANCE = 0.05


def write_nodes(shape: Shape, path: Path, *, named: bool) -> dict[str, str]:
    """Writes an OBJ with an object per part, and returns the node of each part."""
    rows, start, nodes = list[str](), 1, dict[str, str]()
    for number, part in enumerate(shape.parts):
        nodes[part.name] = part.name if named else f"node_{number}"
        rows.append(f"o {nodes[part.name]}")
        for primitive in part.primitives:
            vertices = place_vertices(primitive)
            rows += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in vertices.tolist()]
            rows += ["f " + " ".join(str(start + k) for k in face) for face in primitive.faces.tolist()]
            start += len(vertices)
    path.write_text("\n".join(rows) + "\n")
    return nodes


def judge(part: ShapePart, said: NodeJoint | None, longest: float) -> str:
    """What is wrong with the joint proposed for a part; "" if nothing is."""
    joint = part.joint
    if joint is None or said is None:
        return "" if joint is None and said is None else "moves" if joint is None else "still"
    if {said.type, joint.type} not in ({joint.type}, {"revolute", "continuous"}):
        return "type"
    cosine = float(np.dot(said.axis, joint.axis))
    free = joint.type == "continuous" or said.label in ("knob", "wheel")  # turns both ways
    if (abs(cosine) if free else cosine) < np.cos(np.radians(DEGREES)):
        return "axis"
    offset = np.array(said.origin) - joint.origin
    apart = float(np.linalg.norm(offset - (offset @ joint.axis) * joint.axis))
    return "place" if joint.type != "prismatic" and apart > DISTANCE * longest else ""


def judge_shape(shape: Shape, *, named: bool) -> Counter[str]:
    """Numbers of parts by what is wrong with them; "" counts the right ones that move."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{shape.category}.obj"
        nodes = write_nodes(shape, path, named=named)
        try:
            joints = suggest_joints(path, "z", "-x").joints
        except SourceError:
            joints = ()
    own = {joint.nodes[0]: joint for joint in joints}
    points = np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])
    longest = float(np.ptp(points, axis=0).max())
    found = Counter[str]()
    for part in shape.parts:
        wrong = judge(part, own.get(nodes[part.name]), longest)
        if part.joint is not None or wrong:
            found[wrong] += 1
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=3, help="objects of each kind")
    args = parser.parse_args()
    for named in (True, False):
        total = Counter[str]()
        for kind in sorted(kinds()):
            found = sum(
                (judge_shape(draw_shape(kind, seed), named=named) for seed in range(args.count)), Counter()
            )
            total += found
            print(
                f"    {kind}: {found['']} of {sum(found.values())} {dict(found - Counter({'': found['']}))}"
            )
        share = total[""] / max(sum(total.values()), 1)
        print(f"{'named' if named else 'numbered'} nodes: {share:.0%} of {sum(total.values())} parts right")


if __name__ == "__main__":
    main()
