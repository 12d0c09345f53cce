"""Reads SDFormat models: links, joints, shapes and materials, with poses relative to any frame.

Links get the axes of the model as it stands in the file, and their origins at their joints.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from jaxtyping import Float

from artigen.datasets.mechanism import MOVING, Mechanism, make_mechanism, say_dropped
from artigen.errors import SourceError, name_options
from artigen.files.safe_xml import read_xml
from artigen.files.urdf import UrdfJoint, UrdfShape, weld
from artigen.transforms import matrix_from_quat, matrix_from_rpy, shift

SUFFIXES = (".sdf", ".world")
MODEL = "__model__"
WORLD = "world"
ENDLESS = 1e6
"""A limit beyond it (rad, m) is none: SDFormat writes 1e16 where there is none."""
UNUSED = {
    "include": "included models",
    "model": "models within the model",
    "plugin": "plugins",
    "gripper": "grippers",
    "light": "lights",
    "actor": "actors",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class _Model:
    """A model with the poses of its frames in the model as far as they are known."""

    path: Path
    name: str
    element: Element
    version: tuple[int, ...]
    frames: dict[str, Element]
    """Links, joints and frames by name; a link's pose counts before that of a joint of the same name."""
    poses: dict[str, Float[np.ndarray, "4 4"]] = field(default_factory=dict)

    @property
    def owner(self) -> str:
        return f"{self.path}: model {self.name!r}"


def list_sdf_objects(path: Path) -> tuple[str, ...]:
    """Names of the models in a file with several; none where it holds one.

    Raises:
        SourceError: If the file cannot be read.
    """
    models = _list_models(path)
    return tuple(models) if len(models) > 1 else ()


def read_sdf(path: Path, body: str | None = None) -> Mechanism:
    """Reads one model of a file.

    Args:
        body: Name of the model; None where the file holds one.

    Raises:
        SourceError: If the file is invalid or holds several models; names element, value and what is allowed.
    """
    models = _list_models(path)
    if body is None and len(models) > 1:
        raise SourceError(
            f"{path}: holds {len(models)} models ({', '.join(models)}), expected one: "
            "choose it with --body NAME"
        )
    name = next(iter(models)) if body is None else body
    if name not in models:
        raise SourceError(f"{path}: has no model {name!r}, expected {name_options(name, models)}")
    return _build(models[name])


def _list_models(path: Path) -> dict[str, _Model]:
    root, _ = read_xml(path)
    if root.tag != "sdf":
        raise SourceError(f"{path}: root element <{root.tag}>, expected <sdf>")
    version = tuple(int(word) for word in root.get("version", "1.6").split(".") if word.isdigit())
    found = [*root.findall("model"), *root.findall("world/model")]
    if not found:
        raise SourceError(f"{path}: holds no <model>; models that it includes are files of their own")
    return {
        name: _Model(path=path, name=name, element=element, version=version, frames=_list_frames(element))
        for number, element in enumerate(found)
        for name in [element.get("name") or f"model_{number}"]
    }


def _list_frames(model: Element) -> dict[str, Element]:
    return {one.get("name", ""): one for tag in ("frame", "joint", "link") for one in model.findall(tag)}


def _build(model: _Model) -> Mechanism:
    element, T_file_model = model.element, _pose(model.element, model)
    links = {link.get("name", ""): link for link in element.findall("link")}
    if not links or len(links) < len(element.findall("link")):
        raise SourceError(
            f"{model.owner}: holds {len(element.findall('link'))} links, expected names of their own"
        )
    for name in links:
        _find_frame(name, model)
    dropped = Counter({UNUSED[tag]: len(element.findall(tag)) for tag in UNUSED})
    said = element.findall("joint")
    parents = {_text(joint, "child", model): _text(joint, "parent", model) for joint in said}
    if len(parents) < len(said):
        raise SourceError(f"{model.owner}: a link is the child of two joints, expected a tree")
    for name in [*parents, *parents.values()]:
        if name not in links and name != WORLD:
            raise SourceError(
                f"{model.owner}: a joint names link {name!r}, expected one of {', '.join(links)}"
            )
    roots = [
        name
        for name in (*links, WORLD)
        if name not in parents and (name in links or name in parents.values())
    ]
    if not roots or _has_circle(parents):
        raise SourceError(f"{model.owner}: its joints form a circle, expected a tree")
    root = WORLD if WORLD in roots else roots[0]
    origins = {name: np.zeros(3) for name in roots}
    joints = {}
    for joint in said:
        child = _text(joint, "child", model)
        T = T_file_model @ _joint_frame(joint, child, model)
        origins[child] = T[:3, 3]
        joints[child] = _make_joint(joint, T[:3, :3], T_file_model, model)
    made = [_place(joints[child], parents[child], child, origins) for child in joints] + [
        _place(weld(f"{name}_fixed"), root, name, origins) for name in roots if name != root
    ]
    shapes = {
        tag: [
            shape
            for name, link in links.items()
            for one in link.findall(tag)
            for T in [shift(-origins[name]) @ T_file_model @ _find_frame(name, model)]
            for shape in _shape(one, name, T @ _pose(one, model), model, dropped)
        ]
        for tag in ("visual", "collision")
    }
    loose = [name for name in roots if name != root]
    notes = [f"links without joints are fixed to {root!r}: {', '.join(loose)}"] if loose else []
    return make_mechanism(
        model.path,
        model.name,
        [*([WORLD] if root == WORLD and WORLD not in links else []), *links],
        made,
        visuals=shapes["visual"],
        collisions=shapes["collision"],
        notes=[*notes, *say_dropped(dropped)],
    )


def _has_circle(parents: Mapping[str, str]) -> bool:
    done = set[str]()
    for name in parents:
        at, path = name, set[str]()
        while at in parents and at not in done and at not in path:
            path.add(at)
            at = parents[at]
        if at in path:
            return True
        done |= path
    return False


def _place(joint: UrdfJoint, parent: str, child: str, origins: Mapping[str, np.ndarray]) -> UrdfJoint:
    return replace(joint, parent=parent, child=child, T_parent_joint=shift(origins[child] - origins[parent]))


def _text(element: Element, key: str, model: _Model) -> str:
    text = element.findtext(key)
    if text is None:
        raise SourceError(f"{model.owner}: <{element.tag} name={element.get('name')!r}> has no <{key}>")
    return text.strip()


def _numbers(text: str, count: int, what: str, model: _Model) -> np.ndarray:
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.zeros(0)
    if len(values) != count or np.isnan(values).any():
        raise SourceError(f"{model.owner}: <{what}> is {text.strip()!r:.60}, expected {count} numbers")
    return values


def _pose(element: Element, model: _Model) -> Float[np.ndarray, "4 4"]:
    """The pose of an element in the frame that it is given in."""
    pose, T = element.find("pose"), np.eye(4)
    if pose is None or not (pose.text or "").strip():
        return T
    quat = pose.get("rotation_format") == "quat_xyzw"
    values = _numbers(pose.text or "", 7 if quat else 6, "pose", model)
    if not np.isfinite(values).all():
        raise SourceError(f"{model.owner}: <pose> is {values.tolist()}, expected finite numbers")
    T[:3, 3] = values[:3]
    if quat:
        x, y, z, w = values[3:] / np.linalg.norm(values[3:])
        T[:3, :3] = matrix_from_quat(np.array([[w, x, y, z]]))[0]
    else:
        T[:3, :3] = matrix_from_rpy(
            np.radians(values[3:]) if pose.get("degrees") in ("true", "1") else values[3:]
        )
    return T


def _find_frame(name: str, model: _Model) -> Float[np.ndarray, "4 4"]:
    """Pose of a link, joint or frame in the model."""
    chain: list[tuple[str, Element]] = []
    at = name
    while at not in ("", MODEL) and at not in model.poses:
        element = model.frames.get(at)
        if element is None:
            raise SourceError(
                f"{model.owner}: a pose is relative to {at!r}, expected a link, joint or frame of it"
            )
        if len(chain) > len(model.frames):
            raise SourceError(f"{model.owner}: the pose of {at!r} depends on itself")
        chain.append((at, element))
        pose = element.find("pose")
        at = "" if pose is None else pose.get("relative_to", "")
        if not at and element.tag == "joint":
            at = _text(element, "child", model)
        elif not at and element.tag == "frame":
            at = element.get("attached_to", "")
    T = model.poses.get(at, np.eye(4))
    for one, element in reversed(chain):
        T = model.poses[one] = T @ _pose(element, model)
    return T


def _joint_frame(joint: Element, child: str, model: _Model) -> Float[np.ndarray, "4 4"]:
    """Pose of a joint in the model; its own pose counts in its child's frame unless it says otherwise."""
    pose = joint.find("pose")
    base = (pose.get("relative_to", "") if pose is not None else "") or child
    return _find_frame(base, model) @ _pose(joint, model)


def _make_joint(joint: Element, turn: np.ndarray, T_file_model: np.ndarray, model: _Model) -> UrdfJoint:
    """A joint without parent, child and place; its axis in the axes of the file.

    Args:
        turn: Rotation of the joint's frame in the file.
    """
    name, kind = joint.get("name", ""), joint.get("type", "")
    where = f"{model.owner}: joint {name!r}"
    if kind == "fixed":
        return weld(name)
    if kind not in MOVING:
        raise SourceError(f"{where}: type {kind!r} is not one of fixed, {', '.join(MOVING)}")
    axis = joint.find("axis")
    if axis is None:
        raise SourceError(f"{where}: has no <axis>")
    said = axis.find("xyz")
    direction = _numbers("0 0 1" if said is None else said.text or "", 3, "xyz", model)
    frame = "" if said is None else said.get("expressed_in", "")
    old = axis.findtext("use_parent_model_frame", "true" if model.version < (1, 5) else "false")
    if frame or old.strip() in ("true", "1"):
        turn = (T_file_model @ _find_frame(frame or MODEL, model))[:3, :3]
    limits = [
        float(_numbers(axis.findtext(f"limit/{side}", far), 1, side, model)[0])
        for side, far in (("lower", "-inf"), ("upper", "inf"))
    ]
    endless = kind == "continuous" or max(map(abs, limits)) > ENDLESS
    if endless and kind == "prismatic" and axis.find("mimic") is None:
        raise SourceError(f"{where}: slides without limits, expected <limit> with <lower> and <upper>")
    made = replace(
        weld(name),
        type="continuous" if endless and kind == "revolute" else kind,
        axis=turn @ direction,
        lower=None if endless else limits[0],
        upper=None if endless else limits[1],
    )
    mimic = axis.find("mimic")
    if mimic is None:
        return made
    factor, offset, reference = (
        float(_numbers(mimic.findtext(key, default), 1, key, model)[0])
        for key, default in (("multiplier", "1"), ("offset", "0"), ("reference", "0"))
    )
    leader = mimic.get("joint", "")
    if all(other.get("name") != leader for other in model.element.findall("joint")):
        raise SourceError(f"{where}: mimics joint {leader!r}, which does not exist")
    return replace(made, mimic=leader, mimic_multiplier=factor, mimic_offset=offset - factor * reference)


def _shape(
    element: Element, link: str, T: np.ndarray, model: _Model, dropped: Counter[str]
) -> Iterator[UrdfShape]:
    """One shape; none where it is of a sort that no package has."""
    geometry = element.find("geometry")
    shape = next(iter(geometry), None) if geometry is not None else None
    kinds = {
        "box": ("size",),
        "cylinder": ("radius", "length"),
        "capsule": ("radius", "length"),
        "sphere": ("radius",),
    }
    kind = "nothing" if shape is None else shape.tag
    if shape is None or (kind != "mesh" and kind not in kinds):
        dropped[f"{element.tag} shapes of kind {kind}"] += 1
        return
    sizes: tuple[float, ...] = ()
    for key in kinds.get(kind, ()):
        sizes += tuple(_numbers(_text(shape, key, model), 3 if key == "size" else 1, key, model).tolist())
    if min(sizes, default=1.0) <= 0.0 or not np.isfinite(sizes).all():
        raise SourceError(f"{model.owner}: {kind} {list(sizes)} has no extent, expected lengths above 0")
    dropped["submeshes, the whole mesh instead"] += shape.find("submesh") is not None
    x, y, z = _numbers(shape.findtext("scale", "1 1 1"), 3, "scale", model).tolist()
    color, opacity, texture = _look(element, model, dropped)
    yield UrdfShape(
        link=link,
        name=element.get("name", ""),
        kind=kind,
        T_link_shape=T,
        file=_text(shape, "uri", model) if kind == "mesh" else "",
        sizes=sizes,
        scale=(x, y, z),
        color=color,
        opacity=opacity,
        texture=texture,
    )


def _look(
    element: Element, model: _Model, dropped: Counter[str]
) -> tuple[tuple[float, float, float] | None, float, str]:
    """Colour, opacity and image of a visual."""
    material = element.find("material")
    hidden = float(_numbers(element.findtext("transparency", "0"), 1, "transparency", model)[0])
    if material is None:
        return None, 1.0 - hidden, ""
    dropped["material scripts"] += material.find("script") is not None
    image = (material.findtext(".//albedo_map") or "").strip()
    said = (material.findtext("diffuse") or material.findtext("ambient") or "").split()
    if not said:
        return None, 1.0 - hidden, image
    red, green, blue, *alpha = np.clip(_numbers(" ".join(said), len(said), "diffuse", model), 0, 1).tolist()
    return (red, green, blue), (alpha[0] if alpha else 1.0) * (1.0 - hidden), image
