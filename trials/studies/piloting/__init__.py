"""Herds that are guided through tasks by walls and by robots in their place (Fine 2015, section 8.2)."""
