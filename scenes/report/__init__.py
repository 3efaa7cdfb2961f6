"""The report: one page with a viewer and all that an answer says, in one file that needs no network."""
