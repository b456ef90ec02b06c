"""Environments as templates for formations that guide a herd along a trajectory (Fine 2015, section 8.2)."""
