"""The input format as a whole: its versions, its words, its JSON schema."""
