"""Network, disk, clock and screen: what turns the pure plant and the pure control laws into processes."""
