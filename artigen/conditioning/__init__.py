"""User input: parses words and pictures, and compares objects with requests."""
