"""The shapes of documents: pydantic models, strict, closed, in SI once read. Names are not resolved here."""
