"""What the order of picks is worth: rules against each other on the same streams of parts, by table times."""
