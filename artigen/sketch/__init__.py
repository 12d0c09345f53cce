"""Learned generator of exact shapes: objects as rows of primitives, the network, its rules and fault
checks."""
