"""Reads photographs: the kind of the object, and every visible part where it is."""
