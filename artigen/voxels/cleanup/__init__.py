"""Clean-up of sampled cells, one stage per file; `artigen.voxels.cleanup.clean` runs them in order."""
