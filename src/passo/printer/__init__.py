"""The printer: the handlers of its commands, and the boards that execute them."""
