"""The demos: the pumping paper's metals, and where they come from; the disk paper's spheres and road at night."""
