"""What would have helped: small changes of a request, each tried."""
