"""Mass, inertia, materials, links and joints, handles."""
