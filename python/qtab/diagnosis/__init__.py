"""Why a run did not solve its environment, and what to change: one file for each kind of finding."""
