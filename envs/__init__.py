"""Packages in physics engines: loading, gymnasium environments, dynamic checks, validation.

Importing registers the environments, so that ``gym.make("envs:ArtiGen/Actuate-v0", package=folder)`` works.
Heavy dependencies are imported only where they are used.
"""

from envs.registration import ENVIRONMENT_IDS, register_environments

register_environments()

__all__ = ["ENVIRONMENT_IDS", "register_environments"]
