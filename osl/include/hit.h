// A hit: the numbers of the view and the lobe, before any light.

#include "inputs.h"

struct Hit {
    Frame frame;
    vector up;  // geometric normal, local
    float n;      // exponent of the lobe
    float m;      // exponent of the Phong lobe that is as wide
    float theta;  // angle of the view, in radians
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
