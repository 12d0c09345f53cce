"""Outlines: which parts an object has, where each lies and how it moves, as one row of numbers per part.

An outline is what a voxel field says about its parts and leaves out their shapes: label, joint, box. The
paper draws everything at once (section 4.1); `artigen.models.outline.flow` draws the outline first, in
which neighbouring fronts are apart by construction, and the structure flow fills it with cells.
"""
