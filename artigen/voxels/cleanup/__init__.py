"""Clean-up of drawn cells, one stage per file; `artigen.voxels.cleanup.clean` runs them in order."""
