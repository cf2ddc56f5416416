"""What is measured: sensors with their errors, and what flight software is given of their readings."""
