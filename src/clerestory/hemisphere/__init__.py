"""Partitions of the hemisphere by Klems, Tregenza, Reinhart and Shirley–Chiu."""
