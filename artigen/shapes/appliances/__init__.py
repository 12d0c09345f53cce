"""Components of appliances: housings, doors, racks, drums, controls, hobs."""
