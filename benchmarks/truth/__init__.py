"""What `five_phase_truth.py` is made of: a room, its systems, truth and methods."""
