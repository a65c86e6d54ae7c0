"""Chapter 2: multi-armed bandits."""
