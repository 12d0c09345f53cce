"""Shared by all networks: attention, conditions, rectified flow, stored weights, DINOv2 and CLIP."""
