"""Packages as USD: a SimReady folder for Isaac Sim, Isaac Lab, Newton and others; needs the extra ``usd``."""
