"""Fine 2015, chapter 2: the detection case study on six Creates, and its supplements."""
