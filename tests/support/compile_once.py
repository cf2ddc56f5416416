"""Compile the plant's loop once, before test workers that would each do it share its cache: `python compile_once.py`."""

import plant_flights as pf

pf.flown(seconds=10.0)
