"""The paper's structure VAE and flow on 16^3 latents of articulated voxels."""
