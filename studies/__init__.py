"""One module per figure or table: cases, how to run one, what is claimed, how it is drawn."""
