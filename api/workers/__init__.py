"""The processes that plan, and what runs in them."""
