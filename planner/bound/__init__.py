"""A duration that no plan beats, from the request alone: what the joints' limits and the points of the task need. The
planner states it in its answers, and a check computes it again (`scenes.reading.claims`): recomputed, not proved."""
