"""Files of a printer's card, as clients of the web see and send them."""
