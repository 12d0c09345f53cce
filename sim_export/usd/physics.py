"""Bodies, joints and colliders of a package as UsdPhysics.

Friction and damping of joints are said in the three dialects that engines read: ``newton:`` and
``physxJointAxis:``, which count turning speeds in degrees, and ``mjc:``, which counts them in radians.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, UsdSemantics, UsdShade, Vt

from artigen.transforms import quat_from_matrix
from sim_export.files.obj import corner_normals
from sim_export.geometry.primitives import find_primitive
from sim_export.package import Hull, Inertial, Link, PackageJoint, SimPackage
from sim_export.physics.materials import MATERIALS, MaterialName
from sim_export.usd.labels import SUBSTANCES

# pxr is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

RADIAN = 180.0 / np.pi
"""Degrees."""
BOARD: MaterialName = "wood_board"
"""What a link is of whose parts have no material."""


def add_mass(prim: Usd.Prim, inertial: Inertial, origin: Float[np.ndarray, "3"]) -> None:
    """Mass, centre, and principal moments and axes of a link whose frame stands at ``origin``."""
    moments, axes = np.linalg.eigh(inertial.inertia)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    mass = UsdPhysics.MassAPI.Apply(prim)
    mass.CreateMassAttr(float(inertial.mass))
    mass.CreateCenterOfMassAttr(Gf.Vec3f(*_rounded(inertial.com - origin)))
    mass.CreateDiagonalInertiaAttr(Gf.Vec3f(*_rounded(moments)))
    mass.CreatePrincipalAxesAttr(_quatf(axes))


def add_joint(
    stage: Usd.Stage,
    path: str,
    joint: PackageJoint,
    bodies: dict[str, str],
    origins: dict[str, Float[np.ndarray, "3"]],
) -> Usd.Prim:
    """A joint between two links; a parent without a body is the world."""
    kind = {"prismatic": UsdPhysics.PrismaticJoint, "fixed": UsdPhysics.FixedJoint}.get(
        joint.type, UsdPhysics.RevoluteJoint
    )
    made = kind.Define(stage, path)
    if joint.parent in bodies:
        made.CreateBody0Rel().SetTargets([bodies[joint.parent]])
    made.CreateBody1Rel().SetTargets([bodies[joint.child]])
    start = origins[joint.parent] if joint.parent in bodies else np.zeros(3)
    turn = _quatf(_frame_along(np.asarray(joint.axis, dtype=float)))
    made.CreateLocalPos0Attr(Gf.Vec3f(*_rounded(joint.origin - start)))
    made.CreateLocalPos1Attr(Gf.Vec3f(0.0))
    made.CreateLocalRot0Attr(turn)
    made.CreateLocalRot1Attr(turn)
    prim = made.GetPrim()
    if joint.type == "fixed":
        return prim
    made.CreateAxisAttr("Z")
    in_file = 1.0 if joint.type == "prismatic" else RADIAN
    if joint.type != "continuous":
        made.CreateLowerLimitAttr(float(joint.lower * in_file))
        made.CreateUpperLimitAttr(float(joint.upper * in_file))
    _add_resistance(prim, joint, in_file)
    return prim


def _add_resistance(prim: Usd.Prim, joint: PackageJoint, in_file: float) -> None:
    axis = "linear" if joint.type == "prismatic" else "angular"
    prim.AddAppliedSchema(f"PhysxJointAxisAPI:{axis}")
    prim.AddAppliedSchema("NewtonJointAPI")
    numbers = {
        f"physxJointAxis:{axis}:staticFrictionEffort": joint.friction,
        f"physxJointAxis:{axis}:dynamicFrictionEffort": joint.friction,
        f"physxJointAxis:{axis}:viscousFrictionCoefficient": joint.damping / in_file,
        f"physxJointAxis:{axis}:maxJointVelocity": joint.velocity * in_file,
        "newton:friction": joint.friction,
        "newton:damping": joint.damping / in_file,
        "newton:velocityLimit": joint.velocity * in_file,
    }
    for name, value in numbers.items():
        prim.CreateAttribute(name, Sdf.ValueTypeNames.Float, custom=False).Set(float(value))
    for name, value in {"mjc:frictionloss": joint.friction, "mjc:damping": joint.damping}.items():
        attribute = prim.CreateAttribute(name, Sdf.ValueTypeNames.Double, custom=False)
        attribute.SetVariability(Sdf.VariabilityUniform)
        attribute.Set(float(value))


def add_collider(
    stage: Usd.Stage, path: str, hull: Hull, origin: Float[np.ndarray, "3"], material: UsdShade.Material
) -> None:
    """A hull of a link whose frame stands at ``origin``: a cube, a cylinder or a convex mesh, never drawn."""
    shape = find_primitive(hull)
    if shape is None:
        collider = add_mesh(stage, path, hull.vertices - origin, hull.faces)
        UsdPhysics.MeshCollisionAPI.Apply(collider.GetPrim()).CreateApproximationAttr("convexHull")
    else:
        T = shape.T_object_shape
        if shape.kind == "box":
            collider = UsdGeom.Cube.Define(stage, path)
            collider.CreateSizeAttr(1.0)
            collider.CreateExtentAttr(_extent(np.full(3, 0.5)))
        else:
            radius, length = shape.sizes
            collider = UsdGeom.Cylinder.Define(stage, path)
            collider.CreateAxisAttr("Z")
            collider.CreateRadiusAttr(radius)
            collider.CreateHeightAttr(length)
            collider.CreateExtentAttr(_extent(np.array([radius, radius, length / 2])))
        place = UsdGeom.Xformable(collider)
        place.AddTranslateOp().Set(Gf.Vec3d(*_rounded(T[:3, 3] - origin)))
        place.AddOrientOp().Set(_quatf(T[:3, :3]))
        if shape.kind == "box":
            place.AddScaleOp().Set(Gf.Vec3f(*_rounded(np.array(shape.sizes))))
    collider.CreatePurposeAttr("guide")
    UsdPhysics.CollisionAPI.Apply(collider.GetPrim())
    binding = UsdShade.MaterialBindingAPI.Apply(collider.GetPrim())
    binding.Bind(material, UsdShade.Tokens.weakerThanDescendants, "physics")


def add_mesh(
    stage: Usd.Stage, path: str, vertices: Float[np.ndarray, "V 3"], faces: np.ndarray
) -> UsdGeom.Mesh:
    """Triangles with a normal for every corner."""
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreateSubdivisionSchemeAttr("none")
    points = (np.round(vertices, 7) + 0.0).astype(np.float32)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(faces), 3, dtype=np.int32)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(faces.ravel().astype(np.int32)))
    normals = np.round(corner_normals(vertices, faces).reshape(-1, 3), 5) + 0.0
    mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals.astype(np.float32)))
    mesh.SetNormalsInterpolation("faceVarying")
    mesh.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([points.min(axis=0), points.max(axis=0)])))
    return mesh


def add_physics_material(stage: Usd.Stage, path: str, name: MaterialName) -> UsdShade.Material:
    """Friction of a material of the package."""
    made = UsdShade.Material.Define(stage, path)
    UsdSemantics.LabelsAPI.Apply(made.GetPrim(), "material").CreateLabelsAttr([SUBSTANCES[name].label])
    physics = UsdPhysics.MaterialAPI.Apply(made.GetPrim())
    physics.CreateStaticFrictionAttr(MATERIALS[name].static_friction)
    physics.CreateDynamicFrictionAttr(MATERIALS[name].sliding_friction)
    physics.CreateRestitutionAttr(0.0)
    return made


def keep_apart(stage: Usd.Stage, pairs: Sequence[tuple[str, str]], bodies: dict[str, str]) -> None:
    """Links that touch by design and do not collide."""
    for first, second in pairs:
        filtered = UsdPhysics.FilteredPairsAPI.Apply(stage.GetPrimAtPath(bodies[first]))
        filtered.CreateFilteredPairsRel().AddTarget(bodies[second])


def joined_pairs(package: SimPackage) -> list[tuple[str, str]]:
    """Links that a joint connects, those across a link without collision included."""
    hulls = {link.name for link in package.links if link.hulls}
    return [(j.parent, j.child) for j in package.joints if {j.parent, j.child} <= hulls]


def leading_material(link: Link, materials: dict[str, MaterialName]) -> MaterialName:
    """The material of the part that gives a link its name; board where nothing is said."""
    said: list[MaterialName] = [materials[part] for part in link.parts if part in materials]
    return said[0] if said else BOARD


def _extent(half: Float[np.ndarray, "3"]) -> Vt.Vec3fArray:
    return Vt.Vec3fArray.FromNumpy(np.stack([-half, half]).astype(np.float32))


def _rounded(values: Float[np.ndarray, "N"]) -> list[float]:
    """Numbers without noise digits and negative zeros."""
    return (np.round(values, 9) + 0.0).tolist()


def _quatf(R: Float[np.ndarray, "3 3"]) -> Gf.Quatf:
    return Gf.Quatf(*_rounded(quat_from_matrix(R)))


def _frame_along(axis: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """A rotation that turns z into ``axis``."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])
