"""From an `Asset` to a simulation package: meshes, collision, mass, URDF, and checks on all of it."""
