"""From files to a validated case: includes, tables, overrides, and messages a person can use."""
