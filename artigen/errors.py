"""Errors a caller may want to handle; each message says what was found, where, and what is allowed."""


class ArtigenError(Exception):
    """Base of every error this project raises on purpose."""


class SourceError(ArtigenError):
    """An input object cannot be read: names the file, the element and the value."""


class SegmentationError(ArtigenError):
    """A voxel field does not describe an articulated object."""
