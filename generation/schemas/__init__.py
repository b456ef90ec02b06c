"""Schemas: rules by which environments are generated, one file each (`generation.schema` says what it has)."""
