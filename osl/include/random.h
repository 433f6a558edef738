// Uniform numbers from a hash of the hit.

#define GOLDEN_RATIO 0.6180339887

// The splats of a hit.
struct Draws {
    vector numbers;
    int count;
    float chance;  // that the hit has any
    float spread;  // their width, in parts of the usual one
};

// What tells hits apart whose P is the same. P alone repeats where pixels are finer than its float spacing (far from
// the origin), the view direction alone under an orthographic camera; the place within the triangle and the time do
// not.
float hit_apart(vector view, float place_u, float place_v)
{
    return hashnoise(vector(place_u, place_v, time), view[0] + 3.0 * view[1] + 7.0 * view[2]);
}

// Two numbers per hit.
vector hit_numbers(point hit, vector view, float place_u, float place_v)
{
    float apart = hit_apart(view, place_u, place_v);
    return vector(FIRST_NUMBER(hit, apart), hashnoise(hit, SECOND_HASH + apart), 0.0);
}

// The same and a third.
vector three_numbers(point hit, vector view, float place_u, float place_v)
{
    vector numbers = hit_numbers(hit, view, place_u, place_v);
    numbers[2] = hashnoise(hit, THIRD_HASH + hit_apart(view, place_u, place_v));
    return numbers;
}

// The k-th of count points of a lattice shifted by the hit's numbers: each is uniform, together they are spread out.
// The second coordinate advances by the golden ratio.
float lattice_u(vector numbers, int k, int count) { return SPOILT_U(mod((k + numbers[0]) / count, 1.0)); }
float lattice_v(vector numbers, int k) { return SPOILT_V(mod(numbers[1] + GOLDEN_RATIO * k, 1.0)); }
