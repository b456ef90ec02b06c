"""Hamilton 1971, Vicsek et al. 1995 and Couzin et al. 2005 in kinematic herds."""
