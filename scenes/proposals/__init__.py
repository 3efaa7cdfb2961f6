"""Changes of a request that were tried, as values by their paths: of the request, of the files that it comes from."""
