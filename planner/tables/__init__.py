"""The scene as flat tables of numbers: every column named once, with its unit and meaning."""
