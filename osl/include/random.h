// Uniform numbers from a hash of the hit.

#define GOLDEN_RATIO 0.6180339887

// The samples, and so the kernels, of a hit.
struct Draws {
    vector numbers;  // uniform numbers of the hit
    int count;       // number of samples
    float chance;    // probability that the hit has any
    float spread;    // the kernels' width, in parts of the usual one
};

// A hash that tells apart hits of the same P. P alone repeats where pixels are finer than its float spacing (far from
// the origin), and the view direction alone under an orthographic camera. The position within the triangle and the time
// do not repeat.
float hit_apart(vector view, float place_u, float place_v)
{
    return hashnoise(vector(place_u, place_v, time), view[0] + 3.0 * view[1] + 7.0 * view[2]);
}

// Two uniform numbers per hit.
vector hit_numbers(point hit, vector view, float place_u, float place_v)
{
    float apart = hit_apart(view, place_u, place_v);
    return vector(FIRST_NUMBER(hit, apart), hashnoise(hit, SECOND_HASH + apart), 0.0);
}

// The same two, and a third.
vector three_numbers(point hit, vector view, float place_u, float place_v)
{
    vector numbers = hit_numbers(hit, view, place_u, place_v);
    numbers[2] = hashnoise(hit, THIRD_HASH + hit_apart(view, place_u, place_v));
    return numbers;
}

// The k-th of `count` points of a lattice that is shifted by the hit's numbers. Each point is uniform, and together
// they are well spread. The second coordinate advances by the golden ratio.
float lattice_u(vector numbers, int k, int count) { return SPOILT_U(mod((k + numbers[0]) / count, 1.0)); }
float lattice_v(vector numbers, int k) { return SPOILT_V(mod(numbers[1] + GOLDEN_RATIO * k, 1.0)); }
