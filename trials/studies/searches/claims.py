def claims(run): return []
