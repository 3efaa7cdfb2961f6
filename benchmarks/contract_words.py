"""Messages of the reader for rules that no schema states: used by `benchmarks.contract` and tests."""

NOT_IN_SCHEMA = (", not both", "a number that is not rounded to 0 in ", "a whole number up to 2**53")
"""A quantity in both its units, where one of the keys is a name of a joint; a number so small that it is 0 in SI; a
whole number in a field without a bound that not every reader of JSON has exactly."""
AT_MOST = "at most one of "
"""First words of the reader's message for a rule that the service's description states as `x-at-most-one`."""
