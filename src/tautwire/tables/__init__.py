"""Tables as people own them: sheets of spreadsheets and CSV files, matched to a line by meaning."""
