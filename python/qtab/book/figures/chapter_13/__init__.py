"""Chapter 13: policy gradient methods."""
