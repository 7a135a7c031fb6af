"""Makes configured boards, real or simulated, from a machine file."""
