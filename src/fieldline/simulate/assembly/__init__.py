"""From the records of a scenario to the arrays that the compiled loop flies."""
