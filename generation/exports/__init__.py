"""Environments for drawing programs and workshops: SVG, and fences to build as STL and 3MF. A file a format."""
