"""Lobe rows: the form in which any formula renders.

A formula whose parameters are fixed is a function of view and light. For each of a set of views, a row, it is split
over the half vectors H, where a lobe hardly moves as the view does:

- a base: Beckmann microfacets and a diffuse closure, which the renderer evaluates, fitted to the formula from below;
- the residual: the difference, in cells of about equal energy. At a hit a shader samples some of the cells, in each a
  half vector, and puts a kernel about it, a narrow facet.

Between two rows a shader takes either by chance, in proportion to how near it is. The expected value is the linear
interpolation between them. Where the base is above the formula nothing can take light away; as much is taken from the
whole base, so that no row makes light.

`layout` says which views rows are for, `lobe_rows` holds their numbers, `view_slice` is a formula seen from one view,
`facets`, `fit` and `residual` make a row of it, `row_bake` makes all rows of a model, `grid` those over ranges of
driven parameters, and `error` measures how far rows are from their formula.
"""
