"""Networks: structure VAE and flow, conditioning, and the layout of public TRELLIS checkpoints."""
