"""Documents in, facts out, and back: requests, scenario files, robot catalogue, meshes, answers.

Arrows point inwards only: `scenes` knows `planner`, `planner` knows nothing of it. Units, the makers' joint
conventions and every limit of size live here, at the border. Importing anything of this package loads neither fcl, nor
ruckig, nor trimesh, nor scipy: they come when a scene is planned or a mesh is read.
"""
