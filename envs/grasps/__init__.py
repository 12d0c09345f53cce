"""Grasps, proven in physics: a gripper of boxes closes on a handle and carries it along its joint's path."""
