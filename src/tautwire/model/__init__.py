"""From words to numbers: the only place where specs become arrays."""
