"""Public TRELLIS checkpoints, loaded from local folders."""
