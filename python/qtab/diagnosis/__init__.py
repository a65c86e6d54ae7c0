"""Reasons why a run did not solve its environment, and changes to try: one file for each kind of finding."""
