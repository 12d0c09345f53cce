"""Goals in words for rooms and flats, with success by the state of joints and things, in any engine."""
