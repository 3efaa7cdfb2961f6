"""What is shown of a motion: poses over time, distances over time, shapes as triangles."""
