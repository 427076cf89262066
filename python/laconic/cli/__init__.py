"""The command line: the command `laconic`, its options and its streams.

`commands` has one module a command; each defines a click command called `command`.
"""
