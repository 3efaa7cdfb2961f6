"""Motion planning for SCARA-type robots when targets and obstacles move: planner, scenes, api, experiments."""
