"""`python -m bridge` is the command `hydrotwin`."""

from bridge.cli import main

main()
