"""Robots of URDF files, brought into the form of our own robot files.

`assur.scenes.urdf.importing` has the public functions. A URDF is a tree of links and joints. We can plan for a chain of
three to five joints that one of our families describes exactly. Missing and unsuitable items are reported all at once.
"""
