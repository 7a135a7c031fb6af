"""Files of a printer's card, as clients of the web read and write them."""
