"""Parameter-space maps: which parameters of a schema make environments that elicit a behaviour (Fine 2015, 7.4.2)."""
