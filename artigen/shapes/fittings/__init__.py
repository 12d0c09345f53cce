"""Fronts and fittings: hinges, runners, handles, drawers, latches, feet."""
