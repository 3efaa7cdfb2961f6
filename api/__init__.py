"""The borders of the planner: the HTTP service and the command line. No mathematics lives here."""
