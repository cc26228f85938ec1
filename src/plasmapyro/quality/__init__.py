"""Contradictions in the data of a test, said in words: rules as data, each with its limit and its reason."""
