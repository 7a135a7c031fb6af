"""Jobs without a console: print on the simulated printer, estimate, trace."""
