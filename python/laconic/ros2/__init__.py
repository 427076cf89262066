"""The robot of a scene as a ROS 2 node on plain DDS, without a ROS installation; docs/ros2.md shows it at work.

What the command line needs to explain itself stands here, where no DDS is loaded.
"""

GID_BYTES = {"humble": 24, "iron": 16, "jazzy": 16, "kilted": 16, "lyrical": 16, "rolling": 16}
"""Distributions, and the bytes of a Gid in their graph."""

USUAL_DISTRIBUTION = "jazzy"
MIDDLEWARES = {"cyclonedds": "rmw_cyclonedds_cpp", "fastrtps": "rmw_fastrtps_cpp", "zenoh": "rmw_zenoh_cpp"}
OF_DDS = ("cyclonedds", "fastrtps")
"""What the peers' ROS may use. On DDS topics are the same for all, and services are answered in two ways."""
WITHOUT_HASHES = ("humble",)  # of types, which peers have announced since Iron
FRAMES = {"base": "base_link", "odom": "odom", "map": "map", "imu": "imu_link", "scan": "base_scan"}
"""Coordinate frames by their parts."""
