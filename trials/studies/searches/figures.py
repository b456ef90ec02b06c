def figures(run, folder): return []
