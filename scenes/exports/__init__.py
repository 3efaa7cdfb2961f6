"""Motion for controllers: proved plans that leave as files, and trajectories from elsewhere that are checked."""
