"""What is done with a model: each module is a verb, from a model to a frozen result."""
