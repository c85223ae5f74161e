"""The controller: parameters, fuzzy model, sampled step, interface (and, with later work, design and certificate)."""
