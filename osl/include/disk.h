// The halfway vector disk (Edwards et al. 2006): see addon/models/disk.py. Equations are numbered as in the paper.
//
// Local frame: x is the tangent, z the shading normal. A point h of the disk is (h_u, h_v, 0); the disk's center is
// the in-plane part of the view.

#include "power.h"

// The projections of V+L to the disk, values of `orthogonal`.
#define SCALING 0
#define ORTHOGONAL 1

#define LEAST_HEIGHT2 1e-8  // lights with a smaller squared cosine are below the horizon

struct Disk {
    Frame frame;
    int orthogonal;  // the projection
    vector up;       // geometric normal, local
};

// The disk's map about one of its points.
struct Spot {
    vector light;    // the point's light direction
    vector h;        // unit half vector
    float stretch;   // dh / dL
    float size;      // |V+L|; for scaling, the length of the vector to the point, (h_u, h_v, N.V)
};

Disk make_disk(normal shading, vector tangent, int orthogonal)
{
    Disk d;
    d.frame = tangent_frame(input_normal(shading), Ng, I, tangent);
    d.orthogonal = orthogonal;
    d.up = to_local(d.frame, Ng);
    return d;
}

// The lump's densities on the disk: eq. 27.
struct Lump {
    vector centre;
    vector along;    // unit axis of radii[0]
    vector across;   // unit axis of radii[1]
    float radii[2];
    float n;
};

Lump make_lump(vector centre, float radius_u, float radius_v, float turn, float n)
{
    Lump p;
    p.centre = centre;
    p.along = vector(cos(turn), sin(turn), 0.0);
    p.across = vector(-p.along[1], p.along[0], 0.0);
    p.radii[0] = radius_u;
    p.radii[1] = radius_v;
    p.n = n;
    return p;
}

// Shrinks both radii by one factor so that the larger is at most `allowed`.
void hold_radii(float allowed, output float radius_u, output float radius_v)
{
    float factor = min(1.0, allowed / max(radius_u, radius_v));
    radius_u *= factor;
    radius_v *= factor;
}

// Exponent at a view's cosine, between those at the normal and at grazing: see addon/models/disk_model.py.
float exponent_between(float at_normal, float grazing, float mu)
{
    return pow(at_normal + 1.0, mu) * pow(grazing + 1.0, 1.0 - mu) - 1.0;
}

// Largest radius about the origin that stays on the disk: 1 - sin theta (below eq. 32), without cancellation.
float room_at(float mu) { return mu * mu / (1.0 + sqrt(max(1.0 - mu * mu, 0.0))); }
float disk_room(Disk d) { return room_at(d.frame.view[2]); }

// The standard deviation of a lump along either axis, in parts of its radius.
float lump_deviation(float n) { return SPOILT_DEVIATION(inversesqrt(2.0 * (n + 2.0))); }

// The coordinates of a point h about the lump's center, in units of the radii; and the point of coordinates x, y.
vector lump_at(Lump p, vector h)
{
    vector away = h - p.centre;
    return vector(dot(away, p.along) / p.radii[0], dot(away, p.across) / p.radii[1], 0.0);
}

vector lump_point(Lump p, float x, float y) { return p.centre + x * p.radii[0] * p.along + y * p.radii[1] * p.across; }

// Density over the unit disk of `at`, which is p(h) times the product of the radii.
float unit_lump(vector at, float n)
{
    float r2 = dot(at, at);
    return r2 < 1.0 ? SPOILT_LUMP((n + 1.0) / M_PI * power_of_rest(r2, n)) : 0.0;
}

// The map about the point `h` of the disk. Returns whether its light is above the horizon.
int disk_spot(Disk d, vector h, output Spot s)
{
    vector view = d.frame.view;
    if (d.orthogonal) {
        vector plane = h - vector(view[0], view[1], 0.0);
        float height2 = 1.0 - dot(plane, plane);
        if (height2 <= LEAST_HEIGHT2)
            return 0;
        s.light = vector(plane[0], plane[1], sqrt(height2));
        vector total = s.light + view;
        s.size = length(total);
        s.h = total / s.size;
        s.stretch = s.light[2];  // eq. 23 over 4 (L.H), as |V+L| = 2 (L.H)
        return 1;
    }
    vector total = vector(h[0], h[1], view[2]);
    s.size = length(total);
    s.h = total / s.size;
    float along = dot(view, s.h);
    s.light = 2.0 * along * s.h - view;
    if (along <= 0.0 || s.light[2] <= 0.0)
        return 0;
    s.stretch = SPOILT_STRETCH(view[2] * view[2] / (4.0 * along * s.h[2] * s.h[2] * s.h[2]));  // eq. 19 over 4 (L.H)
    return 1;
}

// The step of the unit half vector when the disk's point moves by `step`.
vector half_step(Disk d, Spot s, vector step)
{
    vector moved = step;
    if (d.orthogonal)
        moved -= vector(0.0, 0.0, dot(s.light, step) / s.light[2]);
    return (moved - dot(moved, s.h) * s.h) / s.size;
}
