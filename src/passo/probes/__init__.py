"""Probes: what each kind needs in the machine file, and how it gets to the bed and back."""
