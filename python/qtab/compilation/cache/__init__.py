"""Machine code, its digest, and its files beside the files of users."""
