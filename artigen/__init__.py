"""artigen: articulated objects for simulation, from a condition to a proven package."""

__version__ = "0.1.0"
