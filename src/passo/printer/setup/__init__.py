"""From a machine file to configured boards, real or simulated."""
