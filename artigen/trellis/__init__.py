"""Public checkpoints (TRELLIS, DINOv2, CLIP), read from local folders."""
