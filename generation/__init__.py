"""Environments that steer a herd: their geometry, schemas that generate them, filters, behaviours, validation, maps."""
