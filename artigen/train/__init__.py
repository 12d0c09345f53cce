"""Training runs: data in shards, losses, the loop."""
