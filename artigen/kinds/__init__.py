"""One file per kind of object, with its record and the function that draws it; see `artigen.kind`."""
