"""A herd that runs across open ground behind a member that the user controls: point masses, or bodies with legs."""
