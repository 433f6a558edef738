// Uniform numbers from a hash of the hit.

// Two numbers per hit. P alone repeats where pixels are finer than its float spacing (far from the origin), the view
// direction alone under an orthographic camera; the place within the triangle and the time tell such hits apart.
vector hit_numbers(point hit, vector view, float place_u, float place_v)
{
    float first = hashnoise(vector(view), place_u + 3.0 * place_v);
    float second = hashnoise(vector(place_u, place_v, time), 7.31 + first);
    return vector(hashnoise(hit, first), hashnoise(hit, 11.5 + second), hashnoise(hit, 23.25 + 0.5 * (first + second)));
}

// The k-th of count points of a lattice shifted by the hit's numbers: each is uniform, together they are spread out.
// The second coordinate advances by the golden ratio.
float lattice_u(vector numbers, int k, int count) { return mod((k + numbers[0]) / count, 1.0); }
float lattice_v(vector numbers, int k) { return mod(numbers[1] + 0.6180339887 * k, 1.0); }
