"""What an operator can see of the service: metrics, and what belongs to one request."""
