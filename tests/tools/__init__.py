"""Golden recordings: small runs that are kept, and compared with what the code does today."""
