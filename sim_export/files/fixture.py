"""A package as a fixture of robosuite, on which RoboCasa and LIBERO build.

``model.xml`` is the MJCF with the object in a body named ``object``, its front towards -y, drawn geometry in
group 1 and collision in group 0. Sites mark its top, bottom and radius, as `MujocoXMLObject` reads them. The
geom ``reg_main``, which neither collides nor weighs, is its box, as RoboCasa's `Fixture` reads it. Box sites
of moving links, such as ``link_0_region``, are regions of LIBERO's problems.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterable

import numpy as np
from jaxtyping import Float

from sim_export.files.urdf import link_origins
from sim_export.files.write import MANIFEST, manifest_text, package_files
from sim_export.package import Hull, SimPackage

MODEL = "model.xml"
GROUPS = {"2": "1", "3": "0"}
"""Groups of geometry in robosuite by ours."""
QUARTER_TURN = "0.70710678118654757 0 0 0.70710678118654757"
"""Turns the front from -x to -y."""


def fixture_files(package: SimPackage) -> dict[str, bytes]:
    """``model.xml`` and the files that it names, by path, with a manifest; raises as `package_files`."""
    files = package_files(package)
    tree = ET.fromstring(files["mobility.mjcf.xml"])
    for geom in tree.iter("geom"):
        geom.set("group", GROUPS[geom.attrib["group"]])
    world = tree.find("worldbody")
    assert world is not None
    body = world.find("body")
    assert body is not None
    world.remove(body)
    body.set("quat", QUARTER_TURN)
    holder = ET.SubElement(world, "body")
    ET.SubElement(holder, "body", name="object").append(body)
    low, high = _box(hull for link in package.links for hull in link.hulls)
    (x, y), (width, depth) = (-(low + high) / 2.0)[1::-1] * (1, -1), (high - low)[1::-1]
    middle, half = (
        np.array([x, y, (low[2] + high[2]) / 2.0]),
        np.array([width, depth, high[2] - low[2]]) / 2.0,
    )
    box = {"type": "box", "pos": _text(middle), "size": _text(half), "rgba": "1 0 0 0"}
    free = {"group": "1", "contype": "0", "conaffinity": "0", "mass": "0"}
    ET.SubElement(holder[0], "geom", {"name": "reg_main"} | box | free)
    up = np.array([0.0, 0.0, half[2]])
    reach = (np.abs(middle) + half) * (1, 1, 0)
    ends = {"bottom_site": middle - up, "top_site": middle + up, "horizontal_radius_site": reach}
    for name, place in ends.items():
        ET.SubElement(holder, "site", name=name, pos=_text(place), size="0.01", rgba="1 0 0 0")
    _add_regions(body, package)
    ET.indent(tree)
    named = {each.attrib["file"] for each in tree.iter() if "file" in each.attrib}
    kept = {path: content for path, content in files.items() if path in named}
    kept[MODEL] = ET.tostring(tree, encoding="unicode").encode()
    return kept | {MANIFEST: manifest_text(kept).encode()}


def _add_regions(body: ET.Element, package: SimPackage) -> None:
    """A box site for every moving link with hulls."""
    origins, found = link_origins(package), {each.attrib["name"]: each for each in body.iter("body")}
    moving = {joint.child for joint in package.joints if joint.type != "fixed"}
    for link in package.links:
        if link.hulls and link.name in moving:
            low, high = _box(link.hulls)
            place = {"pos": _text((low + high) / 2.0 - origins[link.name]), "size": _text((high - low) / 2.0)}
            attributes = {"name": f"{link.name}_region", "type": "box", "quat": "1 0 0 0", "group": "4"}
            ET.SubElement(found[link.name], "site", attributes | place | {"rgba": "1 0 0 0"})


def _box(hulls: Iterable[Hull]) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Lower and upper corner of hulls."""
    corners = np.concatenate([hull.vertices for hull in hulls])
    return corners.min(axis=0), corners.max(axis=0)


def _text(values: Float[np.ndarray, "3"]) -> str:
    return " ".join(f"{value:.6f}" for value in values)
