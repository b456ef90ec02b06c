"""What cameras see: lenses, segmentation by colour, the orange cone and what it tells."""
