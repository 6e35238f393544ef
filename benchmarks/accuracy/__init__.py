"""Studies of how right an answer is when its truth is drawn, or on data of others; run from the project folder."""
