"""`grasps`: where parallel grippers hold an object, found by geometry and proven in physics."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from artigen.api.object import Object, load

if TYPE_CHECKING:
    from envs.sim.load import EngineName
    from sim_export.grasps.find import Found
    from sim_export.package import SimPackage

ENGINES: "tuple[EngineName, ...]" = ("sapien", "mujoco")


def grasps(
    obj: Object | Path | str, gripper: str = "franka", engines: "Sequence[EngineName]" = ENGINES
) -> Object:
    """An object with grasps of every handle in ``package.grasps``, those that were proven first.

    A gripper closes on the handle, moves rigidly with its link by 95 % of the joint's range, and passes if
    the joint has come 90 % of the way and both fingers still touch the link. Where it has no room along the
    whole range, it does so in several strokes, and grasps anew for each. An object in which nothing moves is
    lifted by 20 cm. Of every stroke the best are tried until three pass.

    Args:
        obj: An object, or the folder of its package.
        gripper: franka, robotiq_2f85, or ``parallel:WIDTH`` with a width in metres.
        engines: Engines that must prove a grasp; with none, the best grasps are taken as they are.

    Raises:
        PackageError: If there is no such gripper, or an engine rejects the object.
    """
    obj = obj if isinstance(obj, Object) else load(obj)
    package, _ = add_grasps(obj.package, gripper, engines, obj.folder)
    return Object(name=obj.name, kind=obj.kind, build=lambda: package, shape=obj.shape, scratch=obj.scratch)


def add_grasps(
    package: "SimPackage", gripper: str, engines: "Sequence[EngineName]", folder: Path | None = None
) -> "tuple[SimPackage, tuple[Found, ...]]":
    """A package with the grasps of one gripper instead of those that it had of it, and what was found."""
    from envs.grasps.prove import prove_grasps
    from sim_export.grasps.find import ENOUGH, find_grasps
    from sim_export.grasps.gripper import find_gripper

    hand = find_gripper(gripper)
    found = find_grasps(package, hand)
    if engines:
        found = prove_grasps(package, found, hand, engines, folder)
    else:
        found = tuple(replace(each, grasps=each.grasps[:ENOUGH]) for each in found)
    kept = [grasp for grasp in package.grasps if grasp.gripper != gripper]
    added = [grasp for each in found for grasp in each.grasps]
    return replace(package, grasps=(*kept, *added)), found


def store_grasps(package: "SimPackage", folder: Path) -> None:
    """Writes the grasps of a package into the ``annotations.json`` of its folder.

    Raises:
        PackageError: If the folder is no package of ours, or cannot be written.
    """
    from artigen.datasets.packing import read_folder
    from sim_export.errors import PackageError
    from sim_export.files.sidecars import annotations_json
    from sim_export.files.write import MANIFEST, manifest_text, write_files

    if not (folder / MANIFEST).is_file():
        raise PackageError(f"{folder}: has no {MANIFEST}, so grasps cannot be stored; convert it first")
    files = {name: data for name, data in read_folder(folder).items() if name != MANIFEST}
    files["annotations.json"] = annotations_json(package).encode()
    write_files(files | {MANIFEST: manifest_text(files).encode()}, folder)


def export_grasps(package: "SimPackage", out: Path) -> None:
    """Writes the grasps of a package as ACRONYM and Isaac do, and the closed object as a mesh."""
    import numpy as np

    from sim_export.files.grasp_formats import isaac_text, write_acronym
    from sim_export.files.obj import obj_text
    from sim_export.package import Mesh
    from sim_export.picture.draw import visual_meshes

    meshes = [mesh for link in package.links for visual in link.visuals for mesh in visual_meshes(visual)]
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + start for mesh, start in zip(meshes, first[:-1], strict=True)]
    whole = Mesh(vertices=np.concatenate([x.vertices for x in meshes]), faces=np.concatenate(faces))
    out.mkdir(parents=True, exist_ok=True)
    name = f"{package.name}.obj"
    (out / name).write_text(obj_text(whole, package.name, "plain"))
    for gripper in dict.fromkeys(grasp.gripper for grasp in package.grasps):
        own = [grasp for grasp in package.grasps if grasp.gripper == gripper]
        stem = f"{package.name}_{gripper.replace(':', '_')}"
        write_acronym(package, own, name, out / f"{stem}.h5")
        for link in dict.fromkeys(grasp.link for grasp in own):
            here = [grasp for grasp in own if grasp.link == link]
            (out / f"{stem}_{link}.yaml").write_text(isaac_text(package, link, here))
