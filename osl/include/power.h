// Powers near one, which OSL's fast pow loses: it is off by 0.3 % already at exponents of 100.

#define SMALL_REST 0.5  // up to which the series is good
#define LEAST_DRAWN 1e-7  // uniform numbers are taken to be no less

// (1 - rest)^n for 0 <= rest <= 1, from `rest` itself, so that no digit of it is lost to the one.
float power_of_rest(float rest, float n)
{
    if (rest > SMALL_REST)
        return pow(max(1.0 - rest, 0.0), n);
    // log(1 - rest) = -2 artanh(z), whose series ends early here.
    float z = rest / (2.0 - rest);
    float z2 = z * z;
    float series = 1.0 + z2 * (1.0 / 3.0 + z2 * (1.0 / 5.0 + z2 * (1.0 / 7.0 + z2 * (1.0 / 9.0 + z2 / 11.0))));
    return exp(-2.0 * n * z * series);
}

// 1 - u^(1/n): what is drawn from such a power falls short of one by this.
float rest_of_root(float u, float n) { return -expm1(log(max(u, LEAST_DRAWN)) / n); }
