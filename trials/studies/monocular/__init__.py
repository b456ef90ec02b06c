"""Kirchner 2006: flocking by two cameras."""
