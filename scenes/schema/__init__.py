"""The shapes of documents: pydantic models, strict, closed, in SI once read. No meaning is looked up here."""
