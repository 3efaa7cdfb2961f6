"""A duration that no plan beats, from the request alone: what the joints' limits and the points of the task need."""
