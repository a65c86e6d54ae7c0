"""What training returns: runs, their summaries, and how a run is saved."""
