"""Bags: recordings of topics (rosbag1, rosbag2, MCAP, ULog), read message by message, and written by runs."""
