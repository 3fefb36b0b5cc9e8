"""A rig among the nodes of ROS 2, by the keys, tokens and attachments of rmw_zenoh, and its messages as a package."""
