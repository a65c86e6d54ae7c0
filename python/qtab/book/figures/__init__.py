"""The experiments of the book, by chapter; figures that differ only in a few settings share a module.

Those of several chapters are beside the folders of the chapters.
"""
