"""Whether what an answer says of a plan, beside the plan itself, is so, and options that a plan must keep."""
