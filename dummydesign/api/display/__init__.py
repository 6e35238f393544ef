"""How an answer of a call shows itself: values as attributes, a short line, HTML, tables, plots."""
