"""Flight software that acts: laws from a measurement to a command."""
