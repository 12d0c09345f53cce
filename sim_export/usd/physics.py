"""Rigid bodies, colliders and joints of a package in UsdPhysics, with joint friction in three dialects.

UsdPhysics has neither joint friction nor passive damping. They are written for Newton (``newton:``), PhysX
(``physxJointAxis:``) and MuJoCo (``mjc:``), by the names of their schemas and attributes, which need not be
installed. Friction is a force (N) or torque (N m) in all three. Damping and velocity of turning joints are
per radian for MuJoCo and per degree for the other two, as angles in USD are degrees.
"""

# usd-core has no type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.kind import MaterialName
from artigen.transforms import quat_from_matrix
from artigen.types import Joint
from sim_export.files.mjcf import HARD_IMPEDANCE, HARD_REFERENCE
from sim_export.geometry.primitives import PrimitiveShape, find_primitive
from sim_export.geometry.triangles import area_normals
from sim_export.package import Hull, Inertial
from sim_export.physics.materials import MATERIALS
from sim_export.usd.labels import MATERIAL_WORDS, add_label
from sim_export.usd.looks import define_mesh

if TYPE_CHECKING:
    from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade

_REFERENCE = tuple(map(float, HARD_REFERENCE.split()))
_IMPEDANCE = (*map(float, HARD_IMPEDANCE.split()), 0.5, 2.0)
"""Impedance of screws in MuJoCo: that of the MJCF, and MuJoCo's defaults for what it leaves out."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Frames:
    """Prim path and origin (m, object frame) of every link, by name."""

    paths: "Mapping[str, Sdf.Path]"
    origins: Mapping[str, Float[np.ndarray, "3"]]


def _vector(values: Float[np.ndarray, "3"]) -> "Gf.Vec3f":
    from pxr import Gf

    return Gf.Vec3f(*values.tolist())


def _quat(R: Float[np.ndarray, "3 3"]) -> "Gf.Quatf":
    from pxr import Gf

    return Gf.Quatf(*quat_from_matrix(R).tolist())


def add_body(prim: "Usd.Prim", inertial: Inertial | None, origin: Float[np.ndarray, "3"]) -> None:
    """Makes a link's prim a rigid body; without ``inertial``, engines compute the mass from its colliders."""
    from pxr import UsdPhysics

    UsdPhysics.RigidBodyAPI.Apply(prim)
    if inertial is None:
        return
    moments, axes = np.linalg.eigh(inertial.inertia)
    if np.linalg.det(axes) < 0:
        axes = axes * [1.0, 1.0, -1.0]
    mass = UsdPhysics.MassAPI.Apply(prim)
    mass.CreateMassAttr().Set(float(inertial.mass))
    mass.CreateCenterOfMassAttr().Set(_vector(inertial.com - origin))
    mass.CreateDiagonalInertiaAttr().Set(_vector(moments))
    mass.CreatePrincipalAxesAttr().Set(_quat(axes))


def add_collider(
    stage: "Usd.Stage",
    path: "Sdf.Path",
    hull: Hull,
    origin: Float[np.ndarray, "3"],
    material: "UsdShade.Material",
) -> None:
    """Adds a hull as an invisible collider: a cube or cylinder if it is exactly one, else a convex mesh."""
    from pxr import UsdGeom, UsdPhysics, UsdShade

    found = find_primitive(hull)
    shape = (
        _add_hull(stage, path, hull, origin) if found is None else add_primitive(stage, path, found, origin)
    )
    shape.CreatePurposeAttr().Set(UsdGeom.Tokens.guide)
    prim = shape.GetPrim()
    UsdPhysics.CollisionAPI.Apply(prim)
    if prim.IsA(UsdGeom.Mesh):
        approximation = UsdPhysics.MeshCollisionAPI.Apply(prim).CreateApproximationAttr()
        approximation.Set(UsdPhysics.Tokens.convexHull)
        prim.AddAppliedSchema("NewtonMeshCollisionAPI")
    for schema in ("NewtonCollisionAPI", "MjcCollisionAPI"):
        prim.AddAppliedSchema(schema)
    binding = UsdShade.MaterialBindingAPI.Apply(prim)
    binding.Bind(material, UsdShade.Tokens.weakerThanDescendants, "physics")


def add_primitive(
    stage: "Usd.Stage", path: "Sdf.Path", found: PrimitiveShape, origin: Float[np.ndarray, "3"]
) -> "UsdGeom.Gprim":
    """Adds a cube or cylinder, in a frame with that origin."""
    from pxr import Gf, UsdGeom

    if found.kind == "box":
        shape = UsdGeom.Cube.Define(stage, path)
        shape.CreateSizeAttr().Set(1.0)
        half = np.full(3, 0.5)
    else:
        shape = UsdGeom.Cylinder.Define(stage, path)
        radius, length = found.sizes
        shape.CreateAxisAttr().Set(UsdGeom.Tokens.z)
        shape.CreateRadiusAttr().Set(radius)
        shape.CreateHeightAttr().Set(length)
        half = np.array([radius, radius, length / 2])
    shape.CreateExtentAttr().Set([_vector(-half), _vector(half)])
    T = found.T_object_shape
    shape.AddTranslateOp().Set(Gf.Vec3d(*(T[:3, 3] - origin).tolist()))
    if not np.allclose(T[:3, :3], np.eye(3), atol=1e-9):
        shape.AddOrientOp().Set(_quat(T[:3, :3]))
    if found.kind == "box":
        shape.AddScaleOp().Set(_vector(np.array(found.sizes)))
    return shape


def _add_hull(
    stage: "Usd.Stage", path: "Sdf.Path", hull: Hull, origin: Float[np.ndarray, "3"]
) -> "UsdGeom.Gprim":
    from pxr import UsdGeom, Vt

    mesh = define_mesh(stage, path, hull.vertices - origin, hull.faces)
    weighted = area_normals(hull.vertices[hull.faces])
    lengths = np.linalg.norm(weighted, axis=1, keepdims=True)
    normals = np.where(lengths > 0, weighted / np.where(lengths > 0, lengths, 1.0), [0.0, 0.0, 1.0])
    mesh.CreateNormalsAttr().Set(Vt.Vec3fArray.FromNumpy(normals.astype(np.float32)))
    mesh.SetNormalsInterpolation(UsdGeom.Tokens.uniform)
    return mesh


def add_physics_material(stage: "Usd.Stage", path: "Sdf.Path", name: MaterialName) -> "UsdShade.Material":
    """A material with the friction of `MATERIALS`; masses are given by the links."""
    from pxr import UsdPhysics, UsdShade

    material = UsdShade.Material.Define(stage, path)
    api = UsdPhysics.MaterialAPI.Apply(material.GetPrim())
    api.CreateStaticFrictionAttr().Set(MATERIALS[name].static_friction)
    api.CreateDynamicFrictionAttr().Set(MATERIALS[name].sliding_friction)
    api.CreateRestitutionAttr().Set(0.0)
    add_label(material.GetPrim(), "material", MATERIAL_WORDS[name])
    return material


def fix_to_world(stage: "Usd.Stage", path: "Sdf.Path", root: "Sdf.Path", body: "Sdf.Path") -> None:
    """Fixes the body in place relative to the asset, which need not be at the world's origin."""
    from pxr import UsdPhysics

    fixed = UsdPhysics.FixedJoint.Define(stage, path)
    fixed.CreateBody0Rel().SetTargets([root])  # without a body, the frame refers to the world
    fixed.CreateBody1Rel().SetTargets([body])


def add_joint(stage: "Usd.Stage", path: "Sdf.Path", joint: Joint, frames: Frames) -> None:
    """Adds a joint with its frame in both bodies; the frame's z is the joint's axis."""
    from pxr import UsdPhysics

    kinds = {
        "fixed": UsdPhysics.FixedJoint,
        "prismatic": UsdPhysics.PrismaticJoint,
        "revolute": UsdPhysics.RevoluteJoint,
        "continuous": UsdPhysics.RevoluteJoint,
    }
    made = kinds[joint.type].Define(stage, path)
    made.CreateBody0Rel().SetTargets([frames.paths[joint.parent]])
    made.CreateBody1Rel().SetTargets([frames.paths[joint.child]])
    made.CreateLocalPos0Attr().Set(_vector(joint.origin - frames.origins[joint.parent]))
    made.CreateLocalPos1Attr().Set(_vector(joint.origin - frames.origins[joint.child]))
    if joint.type == "fixed":
        return
    turn = _quat(_from_z(joint.axis))
    made.CreateLocalRot0Attr().Set(turn)
    made.CreateLocalRot1Attr().Set(turn)
    made.CreateAxisAttr().Set(UsdPhysics.Tokens.z)
    if joint.type != "continuous":
        to_file = 1.0 if joint.type == "prismatic" else 180.0 / np.pi
        made.CreateLowerLimitAttr().Set(joint.lower * to_file)
        made.CreateUpperLimitAttr().Set(joint.upper * to_file)
    _add_resistance(made.GetPrim(), joint)


def follow_joint(prim: "Usd.Prim", joint: Joint, leader: "Usd.Prim") -> None:
    """Couples a joint to another one, as on a screw or a pedal bin, for Newton, MuJoCo and PhysX.

    ``newton:mimicCoef1`` is omitted: Newton 1.8 reads it per radian and PhysX (ovphysx 0.7) per degree. PhysX
    requires an instance named after a turning axis for sliding followers too, and limits of the leader.
    """
    from pxr import Sdf, UsdPhysics, Vt

    turn = UsdPhysics.RevoluteJoint(leader)
    if turn and not turn.GetUpperLimitAttr().HasAuthoredValue():
        for attribute, end in (
            (turn.CreateLowerLimitAttr(), joint.lower),
            (turn.CreateUpperLimitAttr(), joint.upper),
        ):
            attribute.Set(float(np.degrees((end - joint.offset) / joint.ratio)))
    prim.AddAppliedSchema("MjcEqualityJointAPI")
    prim.CreateRelationship("mjc:target", custom=False).SetTargets([leader.GetPath()])
    for name, kind, value in (
        ("mjc:coef1", Sdf.ValueTypeNames.Double, joint.ratio),
        ("mjc:solref", Sdf.ValueTypeNames.DoubleArray, Vt.DoubleArray(_REFERENCE)),
        ("mjc:solimp", Sdf.ValueTypeNames.DoubleArray, Vt.DoubleArray(_IMPEDANCE)),
    ):
        prim.CreateAttribute(name, kind, custom=False, variability=Sdf.VariabilityUniform).Set(value)
    if joint.offset != 0.0:
        rest = prim.CreateAttribute("mjc:coef0", Sdf.ValueTypeNames.Double, custom=False)
        rest.Set(joint.offset)
    prim.AddAppliedSchema("PhysxMimicJointAPI:rotZ")
    own = "physxMimicJoint:rotZ:"
    prim.CreateRelationship(f"{own}referenceJoint", custom=False).SetTargets([leader.GetPath()])
    axis = prim.CreateAttribute(f"{own}referenceJointAxis", Sdf.ValueTypeNames.Token, custom=False)
    axis.Set("rotZ")
    gearing = prim.CreateAttribute(f"{own}gearing", Sdf.ValueTypeNames.Float, custom=False)
    # PhysX uses degrees for the leader and for turning followers.
    own_unit = 1.0 if joint.type == "prismatic" else 180.0 / np.pi
    scale = (np.pi / 180.0 if turn else 1.0) * own_unit
    gearing.Set(-joint.ratio * scale)
    if joint.offset != 0.0:
        offset = prim.CreateAttribute(f"{own}offset", Sdf.ValueTypeNames.Float, custom=False)
        offset.Set(-joint.offset * own_unit)


def _from_z(axis: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """The smallest rotation from z to a unit axis."""
    cross = np.cross([0.0, 0.0, 1.0], axis)
    if axis[2] < -1.0 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    x, y, z = cross
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + K + K @ K / (1.0 + axis[2])


def _add_resistance(prim: "Usd.Prim", joint: Joint) -> None:
    """Friction, damping and velocity in each engine's schema, and an inactive drive."""
    from pxr import Sdf, UsdPhysics

    sliding = joint.type == "prismatic"
    way = "linear" if sliding else "angular"
    degrees = 1.0 if sliding else 180.0 / np.pi
    drive = UsdPhysics.DriveAPI.Apply(prim, way)
    drive.CreateTypeAttr().Set(UsdPhysics.Tokens.force)
    drive.CreateStiffnessAttr().Set(joint.stiffness / degrees)
    if joint.spring != 0.0:
        drive.CreateTargetPositionAttr().Set(joint.relaxed * degrees)
    drive.CreateDampingAttr().Set(0.0)
    drive.CreateMaxForceAttr().Set(joint.effort)
    values = {
        "newton:friction": joint.friction,
        "newton:damping": joint.damping / degrees,
        "newton:velocityLimit": joint.velocity * degrees,
        f"physxJointAxis:{way}:staticFrictionEffort": joint.friction,
        f"physxJointAxis:{way}:dynamicFrictionEffort": joint.friction,
        f"physxJointAxis:{way}:viscousFrictionCoefficient": joint.damping / degrees,
        f"physxJointAxis:{way}:maxJointVelocity": joint.velocity * degrees,
    }
    for schema in ("NewtonJointAPI", f"PhysxJointAxisAPI:{way}", "MjcJointAPI"):
        prim.AddAppliedSchema(schema)
    for name, value in values.items():
        prim.CreateAttribute(name, Sdf.ValueTypeNames.Float, custom=False).Set(float(value))
    for name, value in (("mjc:frictionloss", joint.friction), ("mjc:damping", joint.damping)):
        attribute = prim.CreateAttribute(
            name, Sdf.ValueTypeNames.Double, custom=False, variability=Sdf.VariabilityUniform
        )
        attribute.Set(float(value))
