"""What networks share: attention, conditions, rectified flow, stored weights, DINOv2 and CLIP."""
