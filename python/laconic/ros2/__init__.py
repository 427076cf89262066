"""The robot of a scene as a ROS 2 node on plain DDS, without a ROS installation; docs/ros2.md shows it at work.

What the command line needs to explain itself stands here, where no DDS is loaded.
"""

GID_BYTES = {"humble": 24, "iron": 16, "jazzy": 16, "kilted": 16, "lyrical": 16, "rolling": 16}
"""Distributions, and the bytes of a Gid in their graph."""

USUAL_DISTRIBUTION = "jazzy"
MIDDLEWARES = {"cyclonedds": "rmw_cyclonedds_cpp", "fastrtps": "rmw_fastrtps_cpp"}
"""What the peers' ROS may use; clients of the second cannot be answered, so services are left out for it."""
WITHOUT_HASHES = ("humble",)  # of types, which peers have announced since Iron
FRAMES = {"base": "base_link", "odom": "odom", "map": "map", "imu": "imu_link", "scan": "base_scan"}
"""Coordinate frames by their parts."""
