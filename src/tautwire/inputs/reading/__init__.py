"""Files of the user read as plain data and tables, whatever is wrong with them."""
