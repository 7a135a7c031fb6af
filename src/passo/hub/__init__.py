"""A farm: many printers, one queue, one page. It talks to printers only through their API."""
