"""Drawn cells made whole, one stage per file; `artigen.mending.mend` runs them in order."""
