"""Tasks of a cell: the request that a cell file and a task file make together."""
