"""Robots of URDF files, brought into the form of our own robot files.

`assur.scenes.urdf.importing` is the door. A URDF is a tree of links and joints. We can plan for a chain of three to
five joints that one of our families describes exactly. What is missing or unsuitable is told all at once.
"""
