"""What a viewer plays: the tracks of a motion as a document."""
