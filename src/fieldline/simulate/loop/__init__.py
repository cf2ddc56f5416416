"""The compiled loop that flies the plant under its flight software."""
