"""Many trials on all cores: a run, its workers, its folder, how it goes on."""
