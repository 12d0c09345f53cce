"""Training of the appearance models: pictures, features, Gaussians and the sparse flow."""
