// Powers of numbers near 1. OSL's fast pow is not exact enough: its error is 0.3 % already at exponents of 100.

#define SMALL_REST 0.5    // the series is exact up to here
#define LEAST_DRAWN 1e-7  // smaller uniform numbers become this

// (1 - rest)^n for 0 <= rest <= 1. The argument is `rest` itself, as 1 - rest would lose its digits.
float power_of_rest(float rest, float n)
{
    if (rest > SMALL_REST)
        return pow(max(1.0 - rest, 0.0), n);
    // log(1 - rest) = -2 artanh(z), whose series converges fast here.
    float z = rest / (2.0 - rest);
    float z2 = z * z;
    float series = 1.0 + z2 * (1.0 / 3.0 + z2 * (1.0 / 5.0 + z2 * (1.0 / 7.0 + z2 * (1.0 / 9.0 + z2 / 11.0))));
    return exp(-2.0 * n * z * series);
}

// 1 - u^(1/n): 1 minus a sample from such a power.
float rest_of_root(float u, float n) { return -expm1(log(max(u, LEAST_DRAWN)) / n); }
