"""The demo: the pumping paper's metal scene, and where its metals come from."""
