"""Robot herds, Hodgins and Brogan 1994: point masses and one-legged robots under one herding algorithm."""
