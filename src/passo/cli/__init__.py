"""The passo command: one module for each subcommand."""
