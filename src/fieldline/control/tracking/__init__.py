"""Flight software of a vehicle that flies by current beside a target: allocation, regulators over the orbit, prediction."""
