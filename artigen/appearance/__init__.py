"""Appearance: structured latents, their VAE and flow, and the articulation-aware Gaussian decoder."""
