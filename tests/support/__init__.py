"""Parts that tests of several folders share: a whole printer, boards, links, cards."""
