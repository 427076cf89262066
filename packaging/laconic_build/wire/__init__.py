"""The wire contract from `laconic.dbc`: C tables for the node, and the page docs/wire.md."""
