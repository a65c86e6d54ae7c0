"""What keeps compiled code equal to Python: refused constructs, checked operations, and errors in plain words."""
