"""The mind of a member: what it knows, which neighbours it selects, how it decides to move."""
