"""The robot of a scene as a ROS 2 node on plain DDS, without a ROS installation; docs/ros2.md shows it at work."""
