"""Appearance: structured latents, their VAE and flow, the Gaussian decoder, and the features they read."""
