"""How links move: kinematics, sweeps, what must be open first, limits of drawers, pairs never in contact."""
