"""`Object`: an articulated object as a value, with everything that users do with one.

Metres, in the object frame at rest: z up, front -x, the centre of the closed object at the origin.
"""

import sys
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import Float, UInt8

from artigen.api.formats import find_exporter
from artigen.types import Asset, Joint, PartLabel

if TYPE_CHECKING:
    from artigen.camera import Camera
    from artigen.shapes.shape import Shape
    from envs.config import EngineChoice
    from envs.sim.load import EngineName
    from sim_export.package import Grasp, SimPackage, VisualFormat
    from sim_export.picture.image import Layer, Lighting
    from sim_export.picture.view import PackageView
    from sim_export.picture.viewpoint import Viewpoint
    from sim_export.report import Report

REPORT = "validation.json"


@dataclass(frozen=True, kw_only=True)
class ObjectPart:
    """A rigid part of an object: its name, its label, and the joint on which it moves."""

    name: str
    label: PartLabel
    joint: str | None
    """Name in `Object.joints`; None where the part is fixed to its carrier or follows another part."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Object:
    """An articulated object; its package is built when it is first used."""

    name: str
    kind: str
    build: "Callable[[], SimPackage]"
    shape: "Shape | None" = None
    """The exact solids that it was drawn as; None for converted and loaded objects."""
    folder: Path | None = None
    """Its package on disk, if it has one."""
    scratch: "TemporaryDirectory[str] | None" = None
    """Holds files that the object needs, and is removed with it."""

    @cached_property
    def package(self) -> "SimPackage":
        """Links, joints, meshes, hulls, masses and handles, as they are exported."""
        return self.build()

    @cached_property
    def joints(self) -> Mapping[str, Joint]:
        """The joints that can be moved, by their names in all files; lengths in metres, angles in radians."""
        if self.shape is not None:
            return {name: joint for name, (_, joint) in _drawn_joints(self.shape).items()}
        return _package_joints(self.package)

    @cached_property
    def parts(self) -> tuple[ObjectPart, ...]:
        """The rigid parts."""
        if self.shape is not None:
            names = {part: name for name, (part, _) in _drawn_joints(self.shape).items()}
            return tuple(
                ObjectPart(name=part.name, label=part.label, joint=names.get(part.name))
                for part in self.shape.parts
            )
        return _package_parts(self.package)

    @property
    def counts(self) -> Mapping[PartLabel, int]:
        """Number of parts by label."""
        return Counter(part.label for part in self.parts)

    @cached_property
    def size(self) -> tuple[float, float, float]:
        """Width, depth and height (m) of the closed object."""
        if self.shape is not None:
            depth, width, height = np.diff(self.shape.bounds(), axis=0)[0]
        else:
            from sim_export.picture.draw import package_surfaces
            from sim_export.picture.render import surface_points

            depth, width, height = np.ptp(surface_points(package_surfaces(self.package)), axis=0)
        return float(width), float(depth), float(height)

    @property
    def mass(self) -> float:
        """Kilograms of all links; links of foreign packages without inertia count nothing."""
        return sum(link.inertial.mass for link in self.package.links if link.inertial is not None)

    @property
    def notes(self) -> tuple[str, ...]:
        """What was repaired, simplified or left out on the way, one sentence each."""
        return self.package.records

    def __repr__(self) -> str:
        width, depth, height = self.size
        parts, joints = len(self.parts), len(self.joints)
        return (
            f"<{self.kind} {self.name!r}: {parts} part{'s' * (parts != 1)}, {joints} joint"
            f"{'s' * (joints != 1)}, {width:.2f} m wide, {depth:.2f} m deep, {height:.2f} m high>"
        )

    @property
    def report(self) -> "Report | None":
        """The verdict of every check, where its package on disk has one."""
        from sim_export.errors import PackageError
        from sim_export.report import report_from_json

        path = None if self.folder is None else self.folder / REPORT
        if path is None or not path.is_file():
            return None
        try:
            return report_from_json(path.read_text())
        except (ValueError, KeyError, TypeError) as error:
            raise PackageError(f"{path}: is no report ({error}); validate the object again") from error

    def at(self, q: Mapping[str, float] | float) -> Mapping[str, Float[np.ndarray, "4 4"]]:
        """Displacement of every part from rest, by name; it maps points at rest to points in the pose.

        Args:
            q: Coordinates (m, rad) of joints by name, also beyond their limits; the others are closed. Or the
                share of its range, 0 to 1, to which every joint is open, but those that need another one to
                be open further.

        Raises:
            PackageError: If a name is not that of a joint.
        """
        from sim_export.motion.kinematics import link_displacements
        from sim_export.picture.image import read_pose

        links, joints = self.package.links, self.package.joints
        T = link_displacements(links, joints, read_pose(self.package, q))
        return {part: T[index] for index, link in enumerate(links) for part in link.parts}

    def validate(self, *, tasks: bool = False, engines: "tuple[EngineChoice, ...]" = ()) -> "Report":
        """Runs checks L0 to L3 in this process; an object that lies in a folder gets its ``validation.json``.

        Args:
            tasks: Also run checks L4: a robot uses the object in ManiSkill.
            engines: Also run checks L5 in these engines.
        """
        from envs.config import ValidateConfig
        from envs.validate import validate
        from sim_export.files.write import write_package

        cfg = ValidateConfig(tasks="run" if tasks else "none", engines=engines)
        if self.folder is not None:
            return validate(self.folder, cfg)
        with TemporaryDirectory() as scratch:
            return validate(
                write_package(self.package, Path(scratch) / self.name), replace(cfg, output="none")
            )

    def grasps(
        self, gripper: str = "franka", engines: "tuple[EngineName, ...]" = ("sapien", "mujoco")
    ) -> "tuple[Grasp, ...]":
        """Grasps of every handle by one gripper, of each handle those first that engines prove.

        The arguments are those of `artigen.grasps`, which returns an object that is exported with its grasps.

        Raises:
            PackageError: If there is no such gripper, or an engine rejects the object.
        """
        from artigen.api.grasps import add_grasps

        package, _ = add_grasps(self.package, gripper, engines, self.folder)
        return tuple(grasp for grasp in package.grasps if grasp.gripper == gripper)

    def export(
        self,
        folder: Path | str,
        formats: str | tuple[str, ...] = ("package",),
        existing: Literal["refuse", "replace"] = "refuse",
        visual_format: "VisualFormat | None" = None,
    ) -> "Object":
        """Writes the object and returns it as it lies there.

        Args:
            folder: Folder of the package, such as ``out/fridge``: URDF, MJCF, meshes, hulls, masses. One
                that is on disk is copied with its report.
            formats: What is written: ``package``; beside it, or without it instead, ``usd``, an OpenUSD asset
                below ``out/fridge_usd``, ``glb``, a file ``out/fridge.glb``, ``robosuite``, a fixture
                ``out/fridge_robosuite/model.xml``; extensions may add others.
            existing: Refuse or replace what is already there.
            visual_format: ``glb`` adds one GLB per link and ``mobility_glb.urdf``, which shows them, to the
                package, ``obj`` leaves them out; None keeps what the object has.

        Raises:
            ArtigenError: If a format is unknown, a file or folder cannot be written or must not be replaced,
                a source's meshes are to be GLB, or ``usd`` is asked for without usd-core.
        """
        formats = (formats,) if isinstance(formats, str) else formats
        return write_formats(self, Path(folder), formats, existing, visual_format)[0]

    def render(
        self,
        camera: "Camera | Viewpoint | None" = None,
        q: Mapping[str, float] | float = 0.0,
        layer: "Layer" = "visual",
        light: "Lighting" = "quick",
    ) -> UInt8[np.ndarray, "H W 3"]:
        """A picture of the object, sRGB.

        Args:
            camera: A camera in the object frame; or a viewpoint, by default in front, to the left and above,
                from which the posed object fills a picture of 384 x 384 pixels.
            q: Pose, as in `at`.
            layer: ``visual`` meshes, ``collision`` hulls or ``gaussians``.
            light: ``quick``, or ``catalogue`` for a studio by Mitsuba 3 (``pip install "artigen[mitsuba]"``),
                which takes seconds to minutes.

        Raises:
            PackageError: If there is nothing to draw in that layer, or no joint of that name.
        """
        from sim_export.picture.image import render_package

        if layer != "gaussians":
            return render_package(self.package, camera, q, layer, light=light)
        from artigen.api.splats import draw_splats

        return render_package(self.package, camera, q, layer, draw_splats=draw_splats)

    def show(self, port: int = 8080) -> "PackageView":
        """Shows the object in the browser, with a slider for every joint, until its server is stopped.

        The address is written to stderr. ``obj.show().server.sleep_forever()`` keeps a script running.
        """
        from sim_export.picture.view import build_view

        page = build_view(self.package, port=port)
        sys.stderr.write(f"{self.name}: http://localhost:{page.server.get_port()} (stop with Ctrl-C)\n")
        return page


def write_formats(
    obj: Object,
    folder: Path,
    formats: tuple[str, ...],
    existing: Literal["refuse", "replace"],
    visual_format: "VisualFormat | None",
) -> tuple[Object, tuple[Path, ...]]:
    """As `Object.export`, which see; also returns the folder or main file of each format."""
    from artigen.datasets.packing import read_folder
    from sim_export.files.write import MANIFEST, check_place, package_files, write_files

    exporters = [find_exporter(name) for name in formats if name != "package"]
    if "package" in formats:
        check_place(folder, existing)
    package = obj.package
    same = visual_format in (None, package.visual_format)
    if visual_format is not None:
        package = replace(package, visual_format=visual_format)
    files = tuple(write(package, folder, existing) for write in exporters)
    if "package" not in formats:
        return obj, files
    lies = same and obj.folder is not None and (obj.folder / MANIFEST).is_file()
    write_files(read_folder(obj.folder) if obj.folder and lies else package_files(package), folder)
    return replace(obj, folder=folder, build=lambda: package), (folder, *files)


def load(folder: Path | str, *, scratch: "TemporaryDirectory[str] | None" = None) -> Object:
    """The object of a package folder, or of any folder in PartNet-Mobility's layout with a ``mobility.urdf``.

    Args:
        folder: The folder.
        scratch: Temporary folder that holds it, to be removed with the object.

    Raises:
        PackageError: If there is no package or more than one, or something is missing or invalid; the message
            names the file and the value.
    """
    from sim_export.errors import PackageError
    from sim_export.files.folders import find_packages
    from sim_export.files.read import read_package

    found = find_packages([Path(folder)])
    if len(found) != 1:
        names = ", ".join(path.name for path in found[:3])
        raise PackageError(
            f"{folder}: {len(found)} packages ({names}, ...), expected one; load them one by one"
        )
    package = read_package(found[0])
    return Object(
        name=package.name, kind=package.category, build=lambda: package, folder=found[0], scratch=scratch
    )


def open_asset(folder: Path | str) -> Object:
    """The object of an asset folder, as `artigen.io.write_asset` writes it; its package is built when used.

    Raises:
        ArtigenError: If a file is missing or invalid.
    """
    from artigen.io import read_asset

    asset = read_asset(Path(folder))
    source = Path(folder).resolve().name
    return Object(name=asset.name, kind=asset.category, build=partial(_build_asset, asset, source))


def _build_asset(asset: Asset, source: str) -> "SimPackage":
    from artigen import __version__
    from sim_export.export import export_asset

    provenance = {"generator": f"artigen {__version__} export", "source": source}
    return export_asset(asset, provenance=provenance).package


def _drawn_joints(shape: "Shape") -> dict[str, tuple[str, Joint]]:
    """Part and joint by the joint's name in the package: the number of the part among those that move."""
    from artigen.shapes.asset import frame_shape

    center, _ = frame_shape(shape)
    moving = [(part.name, part.joint) for part in shape.parts if part.joint is not None]
    return {
        f"joint_{number}": (part, replace(motion, origin=motion.origin - center))
        for number, (part, motion) in enumerate(moving)
        if motion.follows is None
    }


def _package_joints(package: "SimPackage") -> dict[str, Joint]:
    """The driven joints of a package, by name."""
    from sim_export.motion.kinematics import object_joints

    return {joint.name: joint for joint in object_joints(package.joints)}


def _package_parts(package: "SimPackage") -> tuple[ObjectPart, ...]:
    """The parts of a package, link by link."""
    names = set(_package_joints(package))
    moving = {joint.child: joint for joint in package.joints}
    labels: dict[str, PartLabel] = {
        visual.part: visual.label for link in package.links for visual in link.visuals
    }
    parts = []
    for link in package.links:
        joint = moving.get(link.name)
        own = None if joint is None else joint.follows if joint.is_travel else joint.name
        for index, part in enumerate(link.parts):
            label: PartLabel = labels.get(part) or link.label or "base"
            mover = own if index == 0 and own in names else None
            parts.append(ObjectPart(name=part, label=label, joint=mover))
    return tuple(parts)
