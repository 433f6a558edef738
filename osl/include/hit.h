// What the shader knows of a hit before it looks at any light.

#include "inputs.h"

struct Hit {
    Frame frame;
    float n;
    float m;
    float theta;
};

Hit make_hit(Frame frame, float exponent)
{
    Hit hit;
    hit.frame = frame;
    hit.n = exponent;
    hit.m = lobe_phong_exponent(exponent);
    hit.theta = acos(clamp(frame.view[2], 0.0, 1.0));
    return hit;
}

Hit input_hit(float exponent, int use_roughness, float roughness, normal shading, normal surface, normal geometric,
              vector view)
{
    float n = input_exponent(exponent, use_roughness, roughness);
    // Unlinked, the socket holds zeros: the surface's own normal.
    normal shading_normal = dot(shading, shading) > 1e-8 ? normalize(shading) : surface;
    return make_hit(make_frame(shading_normal, geometric, view), n);
}
