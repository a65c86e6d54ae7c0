"""The experiments of the book, by chapter; figures that differ only in a few settings share a module, those of several chapters beside the folders."""
