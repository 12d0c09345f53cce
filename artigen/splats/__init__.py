"""Gaussian splats: files, motion and seams in numpy; `artigen.splats.render` renders them in torch."""
