"""Packages in physics engines, one adapter for each: loading, posing, and steps in which everything acts.

`envs.sim.load.load` opens a package in an engine. Objects in a scene of your own are loaded by
`envs.sim.sapien.load_package`, tasks and rooms in ManiSkill by `envs.maniskill.load`. In all of them parts
that follow others, springs, joint friction and chains of doors act at every step of the scene.
"""
