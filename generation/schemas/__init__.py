"""Schemas, one a file and named by it: Python (`generation.schema` says what is in one) or a grammar (docs/grammars.md)."""
