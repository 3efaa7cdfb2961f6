"""The service: HTTP in and out, and nothing that plans."""
