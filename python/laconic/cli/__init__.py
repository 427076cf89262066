"""The command line: the command `laconic`, its options, its streams and its subcommands."""
