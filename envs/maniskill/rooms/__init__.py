"""Rooms: what stands in them, where, and the proof that everything opens."""
