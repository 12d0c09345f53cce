"""Writes a package as a folder: all files as bytes first, then one rename into place.

The folder is built beside its final name under a hidden name (``.<name>.partial-*``), so that readers see a
complete package or none. No file contains a time, a path or anything else that depends on when or where it is
written.
"""

import hashlib
import json
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Literal, get_args

from artigen.errors import check_option, explain
from artigen.files.mtl import clean_name
from artigen.splats.motion import transform_gaussians
from artigen.splats.ply import encode_ply
from artigen.transforms import shift
from sim_export.errors import PackageError
from sim_export.files.glb import link_glbs
from sim_export.files.mjcf import mjcf_text, srdf_text
from sim_export.files.obj import hull_obj_text, mtl_text, obj_text, png_bytes
from sim_export.files.sidecars import (
    annotations_json,
    bounding_box_json,
    json_text,
    materials_json,
    meta_json,
    mobility_json,
    physics_json,
    provenance_json,
    semantics_text,
)
from sim_export.files.urdf import (
    GLB_URDF,
    hull_path,
    image_path,
    link_origins,
    normal_path,
    splats_path,
    urdf_text,
    visual_path,
)
from sim_export.geometry.primitives import find_primitive
from sim_export.motion.ignored_pairs import ignored_pairs
from sim_export.package import Link, Mesh, SimPackage, SourceMesh
from sim_export.physics.links import check_kinematics

Overwrite = Literal["refuse", "replace"]
MANIFEST = "manifest.json"
UNHASHED = frozenset({MANIFEST, "validation.json"})
"""Files that are in no manifest; the second is what validation writes."""


def package_files(package: SimPackage) -> dict[str, bytes]:
    """All files of a package by their path in it, including the manifest.

    Raises:
        InvalidKinematics: If links and joints are not a tree that URDF can express.
        PackageError: If a source mesh or one of its images cannot be read, or is to be a GLB.
    """
    check_kinematics(package)
    files: dict[str, bytes] = {}
    origins = link_origins(package)
    for link in package.links:
        for visual in link.visuals:
            if isinstance(visual.mesh, SourceMesh):
                files |= _source_files(visual.mesh, visual_path(visual).removesuffix(".obj"))
                continue
            files[visual_path(visual)] = obj_text(visual.mesh, visual.name, visual.look).encode()
            if f"visual/{visual.look}.mtl" not in files:
                files |= material_files(visual.look, visual.mesh)
        files |= hull_files(link)
        if link.splats is not None:
            own = transform_gaussians(link.splats, shift(-origins[link.name]))
            files[splats_path(link.name)] = encode_ply(own)
    if package.visual_format == "glb":
        files |= link_glbs(package)
    files |= {path: text.encode() for path, text in package_texts(package).items()}
    return files | {MANIFEST: manifest_text(files).encode()}


def hull_files(link: Link) -> dict[str, bytes]:
    """The meshes of the collision hulls of a link that are no box or cylinder, by their path in a package."""
    return {
        hull_path(link, index): hull_obj_text(hull, f"{link.name}_{index}").encode()
        for index, hull in enumerate(link.hulls)
        if find_primitive(hull) is None
    }


def package_texts(package: SimPackage, *, engines: bool = True) -> dict[str, str]:
    """The files of a package that describe it, without those of meshes, by their path in it.

    Args:
        engines: Whether files are included that only engines read: MJCF, SRDF, and the URDFs for ManiSkill
            and of GLBs.

    Raises:
        InvalidKinematics: If links and joints are not a tree that URDF can express.
    """
    check_kinematics(package)
    texts = {
        "mobility.urdf": urdf_text(package),
        "semantics.txt": semantics_text(package),
        "mobility_v2.json": mobility_json(package),
        "meta.json": meta_json(package),
        "bounding_box.json": bounding_box_json(package),
        "annotations.json": annotations_json(package),
        "physics.json": physics_json(package),
        "materials.json": materials_json(package),
        "provenance.json": provenance_json(package),
    }
    if engines:
        pairs = ignored_pairs(package)
        texts["mobility_cvx.urdf"] = urdf_text(package, "maniskill")
        if package.visual_format == "glb":
            texts[GLB_URDF] = urdf_text(package, "glb")
        texts["mobility.srdf"] = srdf_text(package.name, pairs)
        texts["mobility.mjcf.xml"] = mjcf_text(package, pairs)
    return texts


def manifest_text(files: dict[str, bytes]) -> str:
    """SHA-256 of every file in order of their paths."""
    hashes = {path: hashlib.sha256(files[path]).hexdigest() for path in sorted(files) if path not in UNHASHED}
    return json_text(hashes)


def manifest_problems(folder: Path) -> tuple[str, ...]:
    """Differences of a folder from its manifest, one sentence per file; empty if unchanged."""
    path = folder / MANIFEST
    try:
        expected = json.loads(path.read_text())
        assert isinstance(expected, dict)
    except (OSError, ValueError, AssertionError) as err:
        return (f"{MANIFEST} cannot be read ({explain(err)})",)
    there = {
        file.relative_to(folder).as_posix(): file for file in sorted(folder.rglob("*")) if file.is_file()
    }
    problems = [f"{name} is missing" for name in sorted(expected) if name not in there]
    for name, file in there.items():
        if name in UNHASHED:
            continue
        if name not in expected:
            problems.append(f"{name} is not in the manifest")
        elif hashlib.sha256(file.read_bytes()).hexdigest() != expected[name]:
            problems.append(f"{name} was changed")
    return tuple(problems)


def material_files(look: str, mesh: Mesh) -> dict[str, bytes]:
    """MTL and images of a material, which all visuals of its name share."""
    images = {image_path(look): mesh.texture, normal_path(look): mesh.normal_map}
    files = {path: png_bytes(image) for path, image in images.items() if image is not None}
    named = (Path(path).name if image is not None else "" for path, image in images.items())
    return files | {f"visual/{look}.mtl": mtl_text(look, mesh, *named).encode()}


def _source_files(source: SourceMesh, stem: str) -> dict[str, bytes]:
    """A source OBJ with its MTL and images; only the names of referenced files change."""
    name = stem.removeprefix("visual/")
    files: dict[str, bytes] = {}
    lines = []
    for line in _read(source.path).split(b"\n"):
        key, _, value = line.strip().partition(b" ")
        if key != b"mtllib":
            lines.append(line)
        elif f"{stem}.mtl" not in files:
            library = source.path.parent / clean_name(value.decode(errors="replace"))
            files |= _material_files(_inside(library, source.path), stem, source.path)
            lines.append(f"mtllib {name}.mtl".encode())
    files[f"{stem}.obj"] = b"\n".join(lines)
    return files


def _inside(file: Path, source: Path) -> Path:
    """``file``, if it lies in the object's folder, the parent of the mesh's folder; else raises
    `PackageError`."""
    if not file.resolve().is_relative_to(source.parent.parent.resolve()):
        raise PackageError(f"{source}: refers to {file}, which is outside of the object's folder")
    return file


def _material_files(library: Path, stem: str, source: Path) -> dict[str, bytes]:
    """An MTL and its images, which are named by content so that equal ones are shared."""
    files: dict[str, bytes] = {}
    lines = []
    for line in _read(library).split(b"\n"):
        key, _, value = line.strip().partition(b" ")
        if not (key.startswith((b"map_", b"bump", b"disp", b"decal", b"refl", b"norm"))):
            lines.append(line)
            continue
        value = value.strip()
        options = value.rpartition(b" ")[0] if value.startswith(b"-") else b""
        image = _inside(library.parent / clean_name(value.decode(errors="replace")), source)
        content = _read(image)
        target = f"texture_{hashlib.sha256(content).hexdigest()[:12]}{image.suffix.lower()}"
        files[f"visual/{target}"] = content
        lines.append(b" ".join(word for word in (key, options, target.encode()) if word))
    files[f"{stem}.mtl"] = b"\n".join(lines)
    return files


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as err:
        raise PackageError(f"{path}: cannot be read ({err.strerror}); the visual needs it") from err


def write_package(package: SimPackage, folder: Path, overwrite: Overwrite = "refuse") -> Path:
    """Writes a package to ``folder`` and returns the folder; leaves nothing behind on errors.

    Args:
        package: The package.
        folder: The package's own folder; a missing parent is created.
        overwrite: ``refuse`` raises if ``folder`` exists; ``replace`` replaces an existing package, but never
            another kind of folder.

    Raises:
        PackageError: If the folder exists, is not a package, or cannot be written (read-only, full).
        InvalidKinematics: If links and joints are not a tree that URDF can express.
    """
    folder = Path(folder)
    check_place(folder, overwrite)
    write_files(package_files(package), folder)
    return folder


def check_free(path: Path, overwrite: Overwrite) -> None:
    """Refuses what is already there, unless it is to be replaced.

    Raises:
        ArtigenError: If the path exists and must not be replaced.
    """
    check_option("existing", overwrite, get_args(Overwrite))
    if path.exists() and overwrite == "refuse":
        raise PackageError(
            f"{path}: exists already; remove it, or replace it (--existing replace; existing='replace')"
        )


def check_place(folder: Path, overwrite: Overwrite) -> None:
    """Checks that `write_package` may write to a folder.

    Raises:
        PackageError: If the folder exists and is not a package, or must not be replaced.
    """
    check_free(folder, overwrite)
    if (
        folder.exists()
        and not (folder / MANIFEST).is_file()
        and (not folder.is_dir() or any(folder.iterdir()))
    ):
        raise PackageError(f"{folder}: is no package (it has no {MANIFEST}), so it is not replaced")


def write_files(files: Mapping[str, bytes], folder: Path) -> None:
    """Writes files below ``folder`` atomically, replacing its previous content.

    Raises:
        PackageError: If the folder cannot be written (read-only, full).
    """
    scratch: Path | None = None
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        scratch = Path(tempfile.mkdtemp(prefix=f".{folder.name}.partial-", dir=folder.parent))
        for path in sorted(files):
            target = scratch / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(files[path])
        scratch.chmod(0o755)
        _move_into_place(scratch, folder)
    except OSError as err:
        raise PackageError(f"{folder}: cannot be written ({err.strerror or err})") from err
    finally:
        if scratch is not None and scratch.exists():
            shutil.rmtree(scratch, ignore_errors=True)


def _move_into_place(scratch: Path, folder: Path) -> None:
    """Renames ``scratch`` to ``folder``; an old package is renamed first and removed afterwards."""
    if not folder.exists():
        try:
            scratch.rename(folder)
        except OSError:
            if not folder.exists():
                raise  # otherwise another process created a package meanwhile, which is replaced
        else:
            return
    aside = Path(tempfile.mkdtemp(prefix=f".{folder.name}.old-", dir=folder.parent))
    folder.rename(aside)
    try:
        scratch.rename(folder)
    except OSError:
        aside.rename(folder)
        raise
    shutil.rmtree(aside, ignore_errors=True)
