"""Accounts, log-ins and API keys of one web interface."""
