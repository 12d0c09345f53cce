"""Gaussian splats: files, motion and links in numpy; `artigen.splats.render` draws them in torch."""
