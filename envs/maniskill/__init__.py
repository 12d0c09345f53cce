"""ManiSkill on packages: tasks for any folder of them, ManiSkill's own cabinet tasks, populated rooms.

Importing this registers the tasks by way of `envs.registration`; ManiSkill itself is imported when one
is made.
"""
