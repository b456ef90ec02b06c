"""Fine 2015, chapters 6 and 7: environments that are generated, filtered and validated, and tried with Creates."""
