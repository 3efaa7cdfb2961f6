"""From a valid document to the planner's facts: names are looked up here, and units have already gone."""
