"""Lobe rows: the form in which any formula renders.

A formula with fixed parameters is a function of view and light. A row is the formula at one of a set of views. It is a
function of the half vector H, as a lobe over H hardly moves with the view, and has two parts:

- The base: Beckmann microfacets and a diffuse closure, which the renderer evaluates. The fit is from below.
- The residual: the formula minus the base, in cells of about equal energy. At a hit a shader samples some of the cells,
  and in each a half vector. It puts a kernel, a narrow facet, about the half vector.

Between two rows a shader takes either at random, in proportion to how near it is. The expected value is the linear
interpolation between the rows. The base's excess over the formula is taken from the whole base, as no closure takes
light away. So no row makes light.

`layout` has the views of rows, `lobe_rows` their numbers, and `view_slice` a formula seen from one view. `facets`,
`fit` and `residual` make a row of a slice. `row_bake` makes all rows of a model, and `grid` the rows over ranges of
driven parameters. `error` measures the error of rows.
"""
