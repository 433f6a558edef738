// The local frame: x lies in the plane of incidence on the view's side, z is the shading normal. In it the view is
// (sin, 0, cos). All directions are local, except those of closures, which are in world space.

#define NO_LENGTH2 1e-8      // squared length below which a socket's vector has no direction
#define NO_PLANE2 1e-12      // squared sine of a view's angle below which the view is along the normal
// Mirror directions are bent up to this sine of their height above the surface, or this part of the view's if smaller.
#define LOWEST_MIRROR 0.01
#define LOWEST_OF_VIEW 0.9
#define BENT_BEYOND 1.01     // and by this factor further
#define LOWEST_VIEW 1e-4     // least cosine of a view in the frame of a tangent
#define ALONG_AXIS 0.7       // component of a normal from which on its axis is too near for a tangent
#define ALONG_TANGENT 0.9    // the same where the socket's tangent lies along the normal

struct Frame {
    vector x;
    vector y;
    vector z;
    vector view;  // local
};

vector to_world(Frame f, vector v) { return v[0] * f.x + v[1] * f.y + v[2] * f.z; }

vector to_local(Frame f, vector v) { return vector(dot(v, f.x), dot(v, f.y), dot(v, f.z)); }

// Mirror direction of a local view.
vector mirror_of(vector view) { return vector(-view[0], -view[1], view[2]); }

// Bends a shading normal whose mirror direction goes into the surface until it just does not. Cycles does so to every
// glossy closure by itself. Here it is done once, before any weight is computed, so that base and kernels agree.
normal valid_normal(normal shading, normal geometric, vector view)
{
    float lowest = min(LOWEST_OF_VIEW * dot(geometric, view), LOWEST_MIRROR);
    vector mirrored = 2.0 * dot(shading, view) * shading - view;
    float height = dot(mirrored, geometric);
    if (height >= lowest)
        return shading;
    mirrored = normalize(mirrored + BENT_BEYOND * (lowest - height) * geometric);
    return normalize(mirrored + view);
}

Frame make_frame(normal shading, normal geometric, vector view)
{
    Frame f;
    f.z = valid_normal(shading, geometric, view);
    // The view's part across the normal, in the plane of incidence.
    float mu = dot(f.z, view);
    vector across = view - mu * f.z;
    // At normal incidence any tangent serves.
    if (dot(across, across) < NO_PLANE2)
        across = abs(f.z[0]) > ALONG_AXIS ? cross(f.z, vector(0.0, 1.0, 0.0)) : cross(f.z, vector(1.0, 0.0, 0.0));
    f.x = normalize(across);
    f.y = cross(f.z, f.x);
    mu = clamp(mu, 0.0, 1.0);
    f.view = vector(sqrt(1.0 - mu * mu), 0.0, mu);
    return f;
}

// The frame of a tangent, made perpendicular to the shading normal. A zero tangent stands for the direction around the
// object's z axis.
Frame tangent_frame(normal shading, normal geometric, vector view, vector tangent)
{
    Frame f;
    f.z = valid_normal(shading, geometric, view);
    vector along = tangent;
    if (dot(along, along) < NO_LENGTH2)
        along = cross(transform("object", "common", vector(0.0, 0.0, 1.0)), f.z);
    // The part across the normal. A tangent along the normal is replaced.
    along -= dot(along, f.z) * f.z;
    if (dot(along, along) < NO_LENGTH2)
        along = abs(f.z[0]) > ALONG_TANGENT ? cross(vector(0.0, 1.0, 0.0), f.z)
                                            : cross(cross(f.z, vector(1.0, 0.0, 0.0)), f.z);
    f.x = normalize(along);
    f.y = cross(f.z, f.x);
    vector v = vector(dot(f.x, view), dot(f.y, view), max(dot(f.z, view), LOWEST_VIEW));
    f.view = normalize(v);
    return f;
}

// The direction at the cosine 1 - `rest` to a unit axis and at the azimuth phi (Duff et al. 2017).
vector around(vector axis, float rest, float phi)
{
    float s = axis[2] >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + axis[2]);
    float b = axis[0] * axis[1] * a;
    float sin_delta = sqrt(rest * (2.0 - rest));
    return sin_delta * cos(phi) * vector(1.0 + s * axis[0] * axis[0] * a, s * b, -s * axis[0])
         + sin_delta * sin(phi) * vector(b, s + axis[1] * axis[1] * a, -axis[1])
         + (1.0 - rest) * axis;
}
