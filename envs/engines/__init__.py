"""Other engines as witnesses: what becomes of a package in each, every engine in a process of its own."""
