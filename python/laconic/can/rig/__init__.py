"""The test engineer's side: drives a node over CAN, disturbs it and judges it."""
