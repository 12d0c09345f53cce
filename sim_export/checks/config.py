"""Thresholds of the checks L0 to L2: one value for each number of docs/reference/checks.md."""

from dataclasses import dataclass

from sim_export.geometry.distances import MAX_P99


@dataclass(frozen=True, kw_only=True)
class CheckConfig:
    """Every threshold of the static checks. Lengths are metres unless the name says ``ratio``."""

    axis_tolerance: float = 1e-6
    """V005: allowed deviation of an axis from unit length."""
    rest_tolerance: float = 1e-6
    """V005: the lower limit is the rest pose, so it is 0 up to this (m or rad)."""
    turn_tolerance: float = 1e-3
    """V005: a revolute range may exceed a full turn by this (rad); limits are written with few digits."""
    max_links: int = 64
    """V006: PhysX articulations hold at most 64 links."""
    max_hulls_per_link: int = 96
    """V006: more hulls on one link slow every contact query down."""
    max_hulls: int = 256
    """V006: the same for the whole object."""
    min_mass: float = 0.01
    """V007: kg; lighter links make the solver stiff."""
    small_size: float = 0.3
    """V007: objects with a shorter longest edge (m) ..."""
    min_small_mass: float = 0.001
    """... have this limit (kg)."""
    max_mass: float = 500.0
    """V007: kg; heavier links are a unit error."""
    inertia_tolerance: float = 1e-6
    """V008: relative slack of the triangle inequality between principal moments."""
    com_tolerance: float = 1e-3
    """V008: how far (m) the centre of mass may lie outside the link's convex hull."""
    diagonal_range: tuple[float, float] = (0.1, 3.0)
    """V009: bounding-box diagonal (m) of objects of categories without one of their own (`artigen.kind`)."""
    max_faces: int = 50_000
    """V101: triangles per visual mesh."""
    sliver_ratio: float = 1e-4
    """V101: smallest height of a triangle over its longest edge; below it the triangle is degenerate."""
    max_sliver_share: float = 0.01
    """V101: share of a mesh's triangles that may be degenerate (one always may): caps that close a
    T-junction move the surface by nothing, a mesh full of them comes from a broken mesher."""
    convex_volume_ratio: float = 0.999
    """V102: volume of a collision file's surface over the volume of its convex hull."""
    max_hull_vertices: int = 64
    """V102: PhysX on a GPU cooks at most 64."""
    max_hull_polygons: int = 64
    """V102: flat faces, coplanar triangles counted once; PhysX on a GPU cooks at most 64."""
    max_aspect: float = 64.0
    """V102: longest over shortest extent; PhysX refuses oblong hulls on a GPU and replaces them by boxes."""
    min_thickness: float = 1e-3
    """V102: thinnest extent (m) of a hull."""
    max_hausdorff: float = 0.03
    """V103: largest distance between collision and visual surface, as a share of the object's diagonal."""
    max_p99: float = MAX_P99
    """V103: the same for 99 % of the surface."""
    least_diagonal: float = 0.1
    """V103: objects smaller than this (m) have the limits of one as large, 3 and 1.5 mm: hulls are 1 mm thick
    at least (V102) and as far apart, however small the object is."""
    min_iou: float = 0.85
    """V103: volume overlap of collision and closed visual meshes on the grid below."""
    grid_resolution: int = 128
    """V103: cells along the longest edge."""
    min_free_kept: float = 0.9
    """V103: share of a cavity's free cells that the collision geometry leaves free."""
    cavity_cube: float = 0.04
    """V103: edge (m) of the cube that must fit into a cavity for it to count; smaller ones hold nothing."""
    cavity_cube_ratio: float = 1.0 / 16.0
    """V103: the same as a share of the object's longest edge, where that is less."""
    surface_samples: int = 8_000
    """V103: points on the two surfaces; more find smaller bumps and cost time."""
    max_gap: float = 0.005
    """V104: distance (m) of a link from its parent at rest."""
    max_floor_gap: float = 0.005
    """V105: height (m) between the lowest collision and the lowest visual point."""
    max_island: float = 0.005
    """V107: distance (m) of a piece of a link's visual, or of a hull, from the rest of the link."""
    min_texture_coverage: float = 0.99
    """V106: share of a textured mesh's area that has texture under it, and share that is not black."""
    sweep_samples: int = 21
    """V201: fewest poses per joint, the two limits included."""
    sweep_step: float = 0.005
    """V201: farthest (m) that a point may move from one pose to the next; longer steps skip thin parts."""
    max_sweep_samples: int = 401
    """V201: most poses per joint."""
    sobol_poses: int = 64
    """V201: poses of all joints together (a power of two)."""
    max_penetration: float = 0.002
    """V201: depth (m) beyond what overlaps at rest."""
    max_swept_overlap: float = 0.01
    """V201: share of a link's volume that enters another link somewhere on its way."""
    max_rest_overlap: float = 0.001
    """V202: depth (m) at rest between links of which neither is the other's ancestor."""
    max_rest_overlap_parent: float = 0.002
    """V202: depth (m) at rest between a link and its ancestors; a hinge pin sits in its eye."""
    max_edge_ratio: float = 0.05
    """V203: distance of a hinge from the edge of its door, as a share of the door's width; half the door's
    thickness where that is more, since a thick door turns about its middle."""
    blocked_margin: float = 0.02
    """V203: share of sight lines by which two directions must differ to be called different."""
    min_clearance: float = 0.025
    """V204: free depth (m) behind a bar, for fingers."""
    max_grasp_width: float = 0.08
    """V204: width (m) that a parallel gripper spans."""
    min_protrusion: float = 0.005
    """V204: how far (m) a handle must stand out of its panel to be pinched."""
    min_retained: float = 0.1
    """V206: share of a drawer's depth that is still inside its parent when it is open."""
    max_grasp_gap: float = 0.003
    """V207: distance (m) of a pad from what it holds."""
