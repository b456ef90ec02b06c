"""Which laws keep flocking as information, space and synchrony are taken away (Fine 2015, chapters 3, 4 and 9)."""
