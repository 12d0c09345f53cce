"""Converts an `Asset` to a simulation package: meshes, collision, mass, URDF, and static checks."""
