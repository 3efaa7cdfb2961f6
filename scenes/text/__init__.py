"""Text as plain data: what YAML and JSON may hold, and where it stands in the file."""
