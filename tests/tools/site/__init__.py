"""The documentation site: pages gathered from the repository, `make docs`."""
