"""What was asked for: categories, words, counts, lengths and pictures as one request."""
