"""A planned answer as a proof bundle: a document that says all that is needed to prove it, and that a second checker
reads (docs/bundle.md)."""
