// Beckmann microfacets, as Cycles evaluates them.

#define LAMBDA_FROM 0.39     // squared slope of a direction, in widths of the facets, below which Lambda is 0
#define LEAST_COSINE2 1e-12  // smallest divisor for a direction's squared cosine

// Smith's Lambda, by the fit of Walter et al. 2007 in Heitz's form (2014). `slope2` is the squared tangent of the angle
// between the direction and the facet's normal, times the facet's squared width.
float beckmann_lambda(float slope2)
{
    if (slope2 < LAMBDA_FROM)
        return 0.0;
    float a = inversesqrt(slope2);
    return ((0.396 * a - 1.259) * a + 1.0) / ((2.181 * a + 3.535) * a);
}

// The ellipse of half vectors about h that the steps `a` and `b` span.
struct Ellipse {
    vector e1;    // two unit axes across h
    vector e2;
    float xx;     // covariance along these
    float xy;
    float yy;
    float mean;   // the variances along the ellipse's own axes are mean + apart and mean - apart
    float apart;
};

Ellipse ellipse_of(vector h, vector a, vector b)
{
    Ellipse e;
    e.e1 = normalize(dot(a, a) > dot(b, b) ? a : b);
    e.e2 = cross(h, e.e1);
    e.xx = dot(a, e.e1) * dot(a, e.e1) + dot(b, e.e1) * dot(b, e.e1);
    e.xy = dot(a, e.e1) * dot(a, e.e2) + dot(b, e.e1) * dot(b, e.e2);
    e.yy = dot(a, e.e2) * dot(a, e.e2) + dot(b, e.e2) * dot(b, e.e2);
    e.mean = 0.5 * (e.xx + e.yy);
    e.apart = hypot(0.5 * (e.xx - e.yy), e.xy);
    return e;
}
