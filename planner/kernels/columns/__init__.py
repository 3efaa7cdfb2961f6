"""Names of the columns of tables. Importing them loads no compiler."""
