"""Objects written as sequences of primitives: the sketch of an articulated shape."""
