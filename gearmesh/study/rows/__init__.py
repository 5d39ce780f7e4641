"""What one row of a study is: built, solved, and its figures."""
