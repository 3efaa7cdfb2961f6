"""Motion on another grid of times, proved anew; and motion that was made elsewhere, proved or refuted."""
