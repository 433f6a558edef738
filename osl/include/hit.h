// What the shader knows of a hit before it looks at any light.

#include "inputs.h"

struct Hit {
    Frame frame;
    vector up;  // geometric normal, local
    float n;
    float m;
    float theta;
};

Hit make_hit(Frame frame, vector up, float exponent)
{
    Hit hit;
    hit.frame = frame;
    hit.up = up;
    hit.n = exponent;
    hit.m = lobe_phong_exponent(exponent);
    hit.theta = acos(clamp(frame.view[2], 0.0, 1.0));
    return hit;
}

Hit input_hit(float exponent, normal shading)
{
    Frame frame = make_frame(input_normal(shading), Ng, I);
    return make_hit(frame, to_local(frame, Ng), exponent);
}
