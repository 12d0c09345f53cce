"""How jobs run: supervised worker processes, Ray, journals, cores."""
