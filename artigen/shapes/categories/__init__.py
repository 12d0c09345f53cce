"""One file per category; see `artigen.shapes.draw`."""
