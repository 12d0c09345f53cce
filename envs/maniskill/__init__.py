"""Packages in ManiSkill: tasks for any folder of packages, ManiSkill's own cabinet tasks, furnished rooms.

Importing this registers the tasks through `envs.registration`; ManiSkill itself is imported when a task is
created.
"""
