"""Gaussian splats: files and motion in numpy; `artigen.splats.render` renders them in torch."""
