"""A scripted robot: plans from annotations, executed through the environment's actions."""
