"""Errors of the export; messages carry part, measured and allowed values."""

from artigen.errors import ArtigenError


class ExportError(ArtigenError):
    """Base of the export's own errors."""


class OpenMesh(ExportError):
    """A mesh that must enclose a volume does not."""


class DegeneratePart(ExportError):
    """A part has no usable geometry: empty, flat or too small."""


class InvalidInertia(ExportError):
    """Mass or inertia is not physical."""


class InvalidKinematics(ExportError):
    """Joints, limits or the tree cannot be written as URDF."""


class DecompositionFailed(ExportError):
    """Convex decomposition crashed, ran out of time or gave no hull."""


class PackageError(ExportError):
    """A package on disk cannot be read: names the file, the element and the value."""
