"""How carriers move over an interval of time: jets, and those of a tree of links."""
