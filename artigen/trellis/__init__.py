"""Public TRELLIS checkpoints, read from local folders into our networks."""
