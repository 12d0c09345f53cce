"""The learned generator of exact shapes: objects as rows of primitives, network, rules, faults."""
