"""Facts, frozen: the scene, the task, what is held and what may touch, clearances, and the outcome."""
