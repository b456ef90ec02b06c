"""Searches of a schema's parameter space for the environment that elicits a behaviour most robustly."""
