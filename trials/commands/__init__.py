"""The `herd` command: a file for each family of sub-commands, and one that reads their options."""
