"""What goes over the network: messages, bus, link."""
