"""Beyond the maps of Fine 2015: parameters that are optimised, primitives made de novo, and constructs decomposed."""
