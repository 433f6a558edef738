// Uniform numbers from a hash of the hit.

// What tells hits apart whose P is the same. P alone repeats where pixels are finer than its float spacing (far from the
// origin), the view direction alone under an orthographic camera; the place within the triangle and the time do not.
float hit_apart(vector view, float place_u, float place_v)
{
    return hashnoise(vector(place_u, place_v, time), view[0] + 3.0 * view[1] + 7.0 * view[2]);
}

// Two numbers per hit.
vector hit_numbers(point hit, vector view, float place_u, float place_v)
{
    float apart = hit_apart(view, place_u, place_v);
    return vector(hashnoise(hit, apart), hashnoise(hit, 11.5 + apart), 0.0);
}

// The same and a third.
vector three_numbers(point hit, vector view, float place_u, float place_v)
{
    vector numbers = hit_numbers(hit, view, place_u, place_v);
    numbers[2] = hashnoise(hit, 23.5 + hit_apart(view, place_u, place_v));
    return numbers;
}

// The k-th of count points of a lattice shifted by the hit's numbers: each is uniform, together they are spread out.
// The second coordinate advances by the golden ratio.
float lattice_u(vector numbers, int k, int count) { return mod((k + numbers[0]) / count, 1.0); }
float lattice_v(vector numbers, int k) { return mod(numbers[1] + 0.6180339887 * k, 1.0); }
