"""The passo command: one module a subcommand."""
