"""The book's figures and examples, one a file."""
