"""Training: data in shards, losses, the loop."""
