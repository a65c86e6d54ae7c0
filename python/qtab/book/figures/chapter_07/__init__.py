"""Chapter 7: n-step bootstrapping."""
