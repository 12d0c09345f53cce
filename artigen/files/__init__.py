"""Files that any program exchanges, as plain values: OBJ with MTL, and URDF."""
