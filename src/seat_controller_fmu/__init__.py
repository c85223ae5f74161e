"""The controller: its variables, the Takagi-Sugeno model, the sampled control law, and the design of its gains."""
