"""One printer or machine as a whole, for programs, the command line and the web."""
