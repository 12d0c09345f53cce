"""A package as a fixture of robosuite, on which RoboCasa and LIBERO build.

``model.xml`` is the MJCF with the object in a body named ``object``, its front towards -y, drawn geometry in
group 1 and collision in group 0. Sites mark its top, bottom and radius, as `MujocoXMLObject` reads them, and
the corner and ends of its box, as RoboCasa's `Fixture` does.
"""

import xml.etree.ElementTree as ET

import numpy as np
from jaxtyping import Float

from sim_export.files.write import MANIFEST, manifest_text, package_files
from sim_export.package import SimPackage

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
    for name, place in _sites(package).items():
        text = " ".join(f"{number:.6f}" for number in place)
        ET.SubElement(holder, "site", name=name, pos=text, size="0.01", rgba="1 0 0 0")
    ET.indent(tree)
    named = {each.attrib["file"] for each in tree.iter() if "file" in each.attrib}
    kept = {path: content for path, content in files.items() if path in named}
    kept[MODEL] = ET.tostring(tree, encoding="unicode").encode()
    return kept | {MANIFEST: manifest_text(kept).encode()}


def _sites(package: SimPackage) -> dict[str, Float[np.ndarray, "3"]]:
    """Places of the sites by name, in the turned frame."""
    corners = np.concatenate([hull.vertices for link in package.links for hull in link.hulls])
    turned = np.stack([-corners[:, 1], corners[:, 0], corners[:, 2]], axis=1)
    low, high = turned.min(axis=0), turned.max(axis=0)
    ends = {f"ext_p{axis}": np.where(np.arange(3) == k, high, low) for k, axis in enumerate("xyz")}
    middle = (low + high) / 2.0
    return {
        "ext_p0": low,
        **ends,
        "bottom_site": np.array([middle[0], middle[1], low[2]]),
        "top_site": np.array([middle[0], middle[1], high[2]]),
        "horizontal_radius_site": np.array([high[0], high[1], 0.0]),
    }
