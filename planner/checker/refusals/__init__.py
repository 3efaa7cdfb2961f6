"""Whether a refusal that is called proved is proved: the checker's own proofs that there is no plan."""
