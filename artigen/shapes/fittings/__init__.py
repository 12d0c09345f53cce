"""Fronts and what hangs on them: hinges, runners, handles, drawers, feet."""
