"""What proves an outcome, beside the outcome itself."""
