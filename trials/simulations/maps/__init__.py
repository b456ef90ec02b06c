"""Parameter-space maps of schemas: one trial is one map."""
