"""Recorded and planned motion in files of others: one reader of CSV and of ROS messages, for `fit-limits` and
`check-trajectory`."""
