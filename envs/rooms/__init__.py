"""Rooms: furniture, its placement, and checks that everything opens."""
