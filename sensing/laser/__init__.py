"""The Hokuyo URG-04LX-UG01: a planar scan of what stands at its height, with noise, intensities and their codes."""
