"""The results of training: runs, their summaries and their files."""
