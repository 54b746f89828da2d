"""The line piece by piece: between the words of a case and the arrays of a model."""
