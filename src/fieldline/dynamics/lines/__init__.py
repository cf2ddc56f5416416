"""Lines with mass: nodes and segments between two bodies, what their ends do to the bodies, and a reel that feeds them."""
