"""What the reader of a request says where no schema says anything: `benchmarks.contract` and tests go by it."""

NOT_IN_SCHEMA = (", not both", "a number that is not rounded to 0 in ", "a whole number up to 2**53")
"""A quantity in both its units, where one of the keys is a name of a joint; a number so small that it is 0 in SI; a
whole number in a field without a bound that not every reader of JSON has exactly."""
AT_MOST = "at most one of "
"""How the reader begins to speak of what the description of the service tells by `x-at-most-one`."""
