"""The loop as processes: plant, controller, router, and who starts and ends them."""
