"""A scripted robot: plans from annotations, plays them through the environment's own actions."""
