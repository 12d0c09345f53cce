"""Flats: plans of several rooms, each of which `envs.rooms` furnishes, and the whole as one room."""
