"""Drawn cells made whole, one stage per file; `artigen.voxels.cleanup.clean` runs them in order."""
