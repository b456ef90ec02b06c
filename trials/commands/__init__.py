"""The `herd` command: a file for each family of sub-commands, and what their options mean."""
