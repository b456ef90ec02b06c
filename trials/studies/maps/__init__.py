"""Fine 2015, sections 7.4.2 and 8.1: parameter-space maps of the schemas DIRT, DSDR and SIRT."""
