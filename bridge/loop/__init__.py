"""Plant and controller without clock and network: what every mode of the loop runs."""
