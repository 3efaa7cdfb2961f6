"""The borders of the planner: the HTTP service, the command line, and what `import assur` gives. No mathematics lives
here."""
