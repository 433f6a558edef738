// What the shader knows of a hit before it looks at any light.

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
