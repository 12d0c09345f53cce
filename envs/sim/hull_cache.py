"""SAPIEN's cache of collision hulls, which knows paths and not what is there now."""

from pathlib import Path

from ..folder_stamp import folder_stamp

_READ: dict[Path, int] = {}
"""Stamps of the folders whose hulls SAPIEN has read."""


def forget_changed_hulls(folder: Path) -> None:
    """Clears SAPIEN's hulls unless those of a package are its files' as they are; call it before loading.

    Reading and preparing hulls is most of the cost of loading, so that a package which is loaded again keeps
    them. A new one clears those of all others too, and memory does not grow with their number.
    """
    import sapien.physx

    place, stamp = folder.absolute(), folder_stamp(folder)
    if _READ.get(place) != stamp:
        sapien.physx.clear_cache()
        _READ[place] = stamp
