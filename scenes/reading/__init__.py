"""From a valid document to the planner's facts: names are resolved here, and all units are SI already."""
