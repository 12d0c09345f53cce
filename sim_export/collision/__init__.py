"""Convex hulls of links: made of surfaces (`cover`), cut where joints need room, attached, simplified."""
