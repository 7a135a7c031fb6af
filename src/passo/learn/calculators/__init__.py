"""Calculators: experiments without a lesson, one in each file, called CALCULATOR."""
