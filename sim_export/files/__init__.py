"""A package on disk: every file written, and read back."""
