"""The demos: the pumping paper's metals; the disk paper's spheres, road at night and invisible spheres."""
