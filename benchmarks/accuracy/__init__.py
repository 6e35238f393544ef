"""Studies of how right an answer is when its truth is drawn; run from the project folder."""
