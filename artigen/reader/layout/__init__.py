"""From a reading to the object itself: fronts on their plane, cut into the cells of a cabinet."""
