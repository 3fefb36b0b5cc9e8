"""Logs of others: read as one kind of table, mapped to the signals of a drive, and made into a recording."""
