"""The line as arrays and the matrices assembled from them."""
