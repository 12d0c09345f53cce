"""Errors of the export; messages state the part, the measured and the allowed value."""

from artigen.errors import ArtigenError


class ExportError(ArtigenError):
    """Base class of export errors."""


class OpenMesh(ExportError):
    """A mesh is not closed although it must enclose a volume."""


class DegeneratePart(ExportError):
    """A part has no usable geometry: empty, flat or too small."""


class InvalidInertia(ExportError):
    """Mass or inertia is not physical."""


class InvalidKinematics(ExportError):
    """Joints, limits or the tree cannot be expressed in URDF."""


class PackageError(ExportError):
    """A package on disk cannot be read; the message names the file, the element and the value."""
