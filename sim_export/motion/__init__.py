"""How links move: kinematics and sweeps, what must be open first, and limits that keep drawers held."""
