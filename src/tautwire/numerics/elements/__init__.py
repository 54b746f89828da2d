"""Shape functions and the elements made of them."""
