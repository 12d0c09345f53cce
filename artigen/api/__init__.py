"""The Python API and what it is made of: the only layer that joins artigen, sim_export and envs."""
