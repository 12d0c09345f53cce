"""Words and pictures as they come in, and whether an object delivers what was asked."""
