#!/usr/bin/env python3
"""Print the golden values that the numerical tests compare against.

Run without arguments:  python3 print_golden.py

Needs Python 3.9 or newer and mpmath 1.3.  Writes five files beside itself, in about a minute:

    special.csv       erf, erfc and the inverse error function
    gamma_q.csv       logarithm of the regularised upper incomplete gamma function
    fresnel.csv       exact reflectance of a plane interface, real or complex index
    rough_mirror.csv  directional albedo of a lossless rough mirror at normal incidence
    distribution.csv  GGX and Beckmann microfacet distributions and their projected areas

Every input in the files is a binary64 number, printed with repr() so that it reads back exactly.
Every output belongs to exactly that input (not to the decimal or real number the input was rounded
from), is worked out with DIGITS decimal digits, and is then rounded once to 17 significant digits.
17 digits name a binary64 number uniquely, so a test may read an output as f64 and rely on it to
within one unit in the last place.

Nothing here uses the platform's libm: all inputs that need a root or a sine come out of mpmath and
are rounded to binary64, so the files are the same on every machine.

The assertions check the formulas by a second route wherever there is one; the script writes no file
unless all of them hold.
"""

import decimal
import math
import os
import tempfile

from mpmath import mp, mpf, mpc

# Working precision, in decimal digits.  The worst cancellation below (Beckmann's projected area seen
# from below the horizon) costs about a dozen digits, which leaves more than 40.
DIGITS = 60

HERE = os.path.dirname(os.path.abspath(__file__))


# --------------------------------------------------------------------------------------------------
# Numbers in and out
# --------------------------------------------------------------------------------------------------

# The division in out() is the only rounding on the way to the file.  The exponent range is wide
# enough for subnormal results.
SEVENTEEN = decimal.Context(prec=17, rounding=decimal.ROUND_HALF_EVEN, Emax=999999, Emin=-999999)


def nearest(x):
    """The binary64 number nearest to x (mpmath rounds to nearest; -0.0 becomes 0.0)."""
    return float(mpf(x)) + 0.0


def inp(x):
    """Text of an input: the shortest decimal that reads back as the same binary64 number."""
    assert isinstance(x, float)
    return repr(x)


def out(x):
    """Text of an output, correctly rounded to 17 significant digits.

    mp.nstr() works with three guard digits and so can miss a close rounding; an mpf is an integer
    times a power of two, and dividing integers in decimal arithmetic rounds exactly once.
    """
    x = mpf(x)
    assert mp.isfinite(x)
    sign, mantissa, exponent, _ = x._mpf_
    top, bottom = int(mantissa), 1
    if exponent >= 0:
        top <<= exponent
    else:
        bottom <<= -exponent
    value = SEVENTEEN.divide(decimal.Decimal(-top if sign else top), decimal.Decimal(bottom))
    if value == 0:
        return "0.0"
    value = value.normalize(SEVENTEEN)
    if -5 <= value.adjusted() < 16:
        text = format(value, "f")
        return text if "." in text else text + ".0"
    return format(value, "e")


def write(name, header, rows):
    """Write one file, whole or not at all: into a temporary file, then moved into place."""
    columns = header.count(",") + 1
    assert all(row.count(",") + 1 == columns for row in rows), name
    text = "\n".join([header] + rows) + "\n"
    handle, temporary = tempfile.mkstemp(prefix="." + name, dir=HERE)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(text.encode("ascii"))
        os.chmod(temporary, 0o644)
        os.replace(temporary, os.path.join(HERE, name))
    except BaseException:
        os.unlink(temporary)
        raise
    print(f"{name}: {len(rows)} rows, {len(text)} bytes")


def close(a, b, digits):
    """Do a and b agree to so many significant digits?"""
    return abs(a - b) <= mpf(10) ** -digits * max(abs(a), abs(b))


# --------------------------------------------------------------------------------------------------
# special.csv: erf, erfc, erf_inv
# --------------------------------------------------------------------------------------------------

HEADER_SPECIAL = "function,x,value"


def error_function_points():
    """Arguments that erf and erfc share."""
    points = {0.0}
    # Tiny: subnormal, smallest normal, and down to where the cubic term starts to show.
    for exponent in (-1074, -1022, -500, -100, -60, -53, -40, -30):
        points |= {math.ldexp(1.0, exponent), -math.ldexp(1.0, exponent)}
    # Steps of 1/8 over [-6, 6].
    points |= {i / 8.0 for i in range(-48, 49)}
    # Where common implementations change from one approximation to the next, with both neighbours
    # so that each side of the join is met.
    for join in (0.25, 0.46875, 0.84375, 1.25, 1.0 / 0.35, 4.0, 5.9, 6.0):
        points |= {join, math.nextafter(join, 0.0), math.nextafter(join, math.inf), -join}
    return points


def erf_inverse(x):
    """y with erf(y) = x, for the exact value of the binary64 number x.

    Newton's method on whichever of erf and erfc is not close to 1 there; 1 - |x| is exact.
    """
    if x == 0:
        return mpf(0)
    target = mpf(abs(x))
    y = mp.erfinv(target)
    for _ in range(3):
        residual = mp.erf(y) - target if target < 0.5 else (1 - target) - mp.erfc(y)
        step = residual * mp.sqrt(mp.pi) / 2 * mp.exp(y * y)
        y -= step
    assert abs(step) < y * mpf(10) ** -(DIGITS - 8), x
    return y if x > 0 else -y


def special_rows():
    shared = error_function_points()
    # Far tail: erfc(26.5) is about 2e-307, just above the smallest normal number.
    tail = {6.25, 6.5, 7.5, 10.03125, 26.25, 26.5} | {float(i) for i in range(7, 27)}
    inverse = {0.0}
    for exponent in (-60, -30, -20, -10):
        inverse |= {math.ldexp(1.0, exponent), -math.ldexp(1.0, exponent)}
    inverse |= {i / 32.0 for i in range(-31, 32)}
    # Towards +-1, as far as binary64 goes.
    for bits in (6, 7, 8, 10, 12, 16, 20, 24, 30, 36, 40, 44, 48, 50, 52, 53):
        x = 1.0 - math.ldexp(1.0, -bits)
        inverse |= {x, -x}

    rows = []
    for name, function, points in (
        ("erf", mp.erf, shared),
        ("erfc", mp.erfc, shared | tail),
        ("erf_inv", erf_inverse, inverse),
    ):
        rows += [f"{name},{inp(x)},{out(function(mpf(x)))}" for x in sorted(points)]

    # Second route: Maclaurin series, Laplace's continued fraction, and the way back.
    series = mp.nsum(lambda n: (-1) ** int(n) / (mp.factorial(n) * (2 * n + 1)), [0, mp.inf])
    assert close(mp.erf(1), 2 / mp.sqrt(mp.pi) * series, 40)
    fraction = mpf(26.5)
    for n in range(400, 0, -1):
        fraction = mpf(26.5) + mpf(n) / 2 / fraction
    assert close(mp.erfc(26.5), mp.exp(-mpf(26.5) ** 2) / (mp.sqrt(mp.pi) * fraction), 40)
    assert all(close(mp.erf(erf_inverse(x)), mpf(x), 40) for x in inverse if x != 0)
    return rows


# --------------------------------------------------------------------------------------------------
# gamma_q.csv: ln Q(a, x)
# --------------------------------------------------------------------------------------------------

HEADER_GAMMA = "a,x,ln_q"

GAMMA_A = (0.5, 1.0, 2.5, 7.5, 15.5, 31.5, 63.5, 127.5, 255.5, 511.5, 1023.5, 2047.5)


def gamma_targets():
    """The values of Q to aim at; x is then rounded to binary64, so that they are met only nearly."""
    upper = [1 - mpf("1e-6"), 1 - mpf("1e-3"), mpf("0.9"), mpf("0.5"), mpf("0.1")]
    return upper + [mpf(10) ** -n for n in (3, 6, 10, 30, 100, 300, 1000, 3000, 10000)]


def gamma_q(a, x):
    """(Q(a, x), Q'(a, x)) for a = 1, or a whole number plus one half.

    Q(1, x) = exp(-x), Q(1/2, x) = erfc(sqrt(x)), and Q(b + 1, x) = Q(b, x) + x^b exp(-x) / Gamma(b + 1):
    a finite sum of positive terms, hence no truncation and no cancellation.
    """
    a, x = mpf(a), mpf(x)
    if a == 1:
        return mp.exp(-x), -mp.exp(-x)
    b = mpf(0.5)
    q = mp.erfc(mp.sqrt(x))
    term = mp.sqrt(x) * mp.exp(-x) / mp.gamma(mpf(1.5))  # x^b exp(-x) / Gamma(b + 1)
    while b < a:
        q += term
        b += 1
        term *= x / b
    assert b == a
    # With b = a the next term is x^a exp(-x) / Gamma(a + 1), and Q' = -x^(a-1) exp(-x) / Gamma(a).
    return q, -term * a / x


def solve_gamma(a, target):
    """x with Q(a, x) = target, good to binary64, by Newton's method on ln Q.

    ln Q is concave in x for a >= 1 and convex for a = 1/2, so that the iteration cannot run away
    from the median side (concave) or from near 0 (convex).
    """
    with mp.workdps(30):
        goal = mp.log(target)
        x = mpf(a) if a >= 1 else mpf(10) ** -14
        for _ in range(200):
            q, slope = gamma_q(a, x)
            step = (mp.log(q) - goal) * q / slope
            x -= step
            if abs(step) < x * mpf(10) ** -20:
                return nearest(x)
    raise ArithmeticError(f"no solution for a = {a}, Q = {target}")


def gamma_rows():
    rows = []
    for a in GAMMA_A:
        for target in gamma_targets():
            x = solve_gamma(a, target)
            ln_q = mp.log(gamma_q(a, x)[0])
            assert close(ln_q, mp.log(target), 6), (a, x)
            rows.append(f"{inp(a)},{inp(x)},{out(ln_q)}")

    # Second route: mpmath's own incomplete gamma function.
    for a, x in ((0.5, 3.0), (2.5, 0.125), (7.5, 40.0), (63.5, 60.0), (255.5, 900.0), (2047.5, 2200.0)):
        assert close(gamma_q(a, x)[0], mp.gammainc(a, x, mp.inf, regularized=True), 40), (a, x)
    return rows


# --------------------------------------------------------------------------------------------------
# fresnel.csv: reflectance of a plane interface
# --------------------------------------------------------------------------------------------------

HEADER_FRESNEL = "material,wavelength_nm,eta,k,theta_deg,reflectance_s,reflectance_p,reflectance"

WAVELENGTHS_NM = (630.0, 532.0, 467.0, 650.0, 550.0, 450.0)

# (eta, k) at each of WAVELENGTHS_NM, in that order: from the refractiveindex.info database (CC0-1.0),
# interpolated in its tables or evaluated from its dispersion formulas, then rounded.  Here they are
# plain inputs: the reflectances are exact for these numbers, whatever their merit as a description
# of the material.
OPTICAL_CONSTANTS = {
    "copper": (
        (0.275269, 3.37255), (1.115884, 2.59558), (1.247854, 2.46454),
        (0.237799, 3.62641), (1.006627, 2.58231), (1.240441, 2.39294),
    ),
    "aluminium": (
        (1.430308, 7.50808), (0.938777, 6.41954), (0.693065, 5.65918),
        (1.558031, 7.71241), (1.015192, 6.62728), (0.633238, 5.45435),
    ),
    "iron": (
        (2.892381, 3.06548), (2.895357, 2.91786), (2.654000, 2.81),
        (2.911429, 3.08929), (2.949697, 2.93182), (2.584500, 2.767),
    ),
    "gold": (
        (0.188361, 3.40338), (0.543863, 2.23087), (1.325024, 1.86295),
        (0.155574, 3.60244), (0.424149, 2.47205), (1.383088, 1.9155),
    ),
    "silver": (
        (0.056909, 4.25432), (0.054007, 3.42899), (0.047854, 2.8235),
        (0.052225, 4.40936), (0.059582, 3.59737), (0.040000, 2.6484),
    ),
    "diamond": (
        (2.412500, 0.0), (2.426016, 0.0), (2.440433, 0.0),
        (2.410495, 0.0), (2.422951, 0.0), (2.445364, 0.0),
    ),
    "glass_N-BK7": (
        (1.515186, 1.20685e-08), (1.519473, 7.76085e-09), (1.523848, 1.01621e-08),
        (1.514520, 1.24515e-08), (1.518522, 7.23501e-09), (1.525320, 1.06448e-08),
    ),
    "water": (
        (1.332180, 0.0), (1.335382, 0.0), (1.338552, 0.0),
        (1.331667, 0.0), (1.334683, 0.0), (1.339608, 0.0),
    ),
}

# Every 5 degrees, and every degree from 85 on.
ANGLES_DEG = tuple(float(i) for i in range(0, 90, 5)) + (86.0, 87.0, 88.0, 89.0)


def fresnel(eta, k, theta_deg):
    """(R_s, R_p) for light from vacuum onto the complex index N = eta + i k."""
    index = mpc(eta, k)
    theta = mpf(theta_deg) * mp.pi / 180
    cos_i = mp.cos(theta)
    # Snell's law sin(theta) = N sin(theta_t).  The radicand lies in the upper half-plane, thus the
    # principal root in the first quadrant: the wave decays into the material.
    cos_t = mp.sqrt(1 - (mp.sin(theta) / index) ** 2)
    r_s = (cos_i - index * cos_t) / (cos_i + index * cos_t)
    r_p = (index * cos_i - cos_t) / (index * cos_i + cos_t)
    return abs(r_s) ** 2, abs(r_p) ** 2


def fresnel_rows():
    rows = []
    for material, constants in OPTICAL_CONSTANTS.items():
        assert len(constants) == len(WAVELENGTHS_NM)
        for wavelength, (eta, k) in zip(WAVELENGTHS_NM, constants):
            for angle in ANGLES_DEG:
                s, p = fresnel(eta, k, angle)
                assert 0 <= p <= s * (1 + mpf(10) ** -40) and s <= 1
                rows.append(
                    f"{material},{inp(wavelength)},{inp(eta)},{inp(k)},{inp(angle)},"
                    f"{out(s)},{out(p)},{out((s + p) / 2)}"
                )
            # Second route: the two cases that have a real closed form.  At normal incidence
            # R = |N - 1|^2 / |N + 1|^2; at 45 degrees R_p = R_s^2 whatever the index.
            e, kk = mpf(eta), mpf(k)
            normal = ((e - 1) ** 2 + kk**2) / ((e + 1) ** 2 + kk**2)
            s, p = fresnel(eta, k, 0.0)
            assert close(s, normal, 40) and close(p, normal, 40)
            s, p = fresnel(eta, k, 45.0)
            assert close(p, s**2, 40)
    return rows


# --------------------------------------------------------------------------------------------------
# distribution.csv: microfacet distributions D and projected areas sigma
# --------------------------------------------------------------------------------------------------

HEADER_DISTRIBUTION = "distribution,alpha_x,alpha_y,x,y,z,d,projected_area"

ALPHAS = ((0.5, 0.5), (0.5, 0.2), (0.3, 0.03), (0.1, 0.1), (0.01, 0.01), (0.001, 0.001), (1.0, 1.0))

# Smaller results are written as 0.
SMALLEST = mpf(10) ** -300


def ggx_d(ax, ay, x, y, z):
    if z <= 0:
        return mpf(0)
    return 1 / (mp.pi * ax * ay * ((x / ax) ** 2 + (y / ay) ** 2 + z * z) ** 2)


def beckmann_d(ax, ay, x, y, z):
    if z <= 0:
        return mpf(0)
    return mp.exp(-((x / ax) ** 2 + (y / ay) ** 2) / (z * z)) / (mp.pi * ax * ay * z**4)


def ggx_area(ax, ay, x, y, z):
    """sigma(w), the integral of D(m) max(0, w.m) over all m."""
    s2 = (ax * x) ** 2 + (ay * y) ** 2
    return (z + mp.sqrt(z * z + s2)) / 2


def beckmann_area(ax, ay, x, y, z):
    s = mp.sqrt((ax * x) ** 2 + (ay * y) ** 2)
    if s == 0:
        return max(z, mpf(0))
    return (z * mp.erfc(-z / s) + s / mp.sqrt(mp.pi) * mp.exp(-((z / s) ** 2))) / 2


DISTRIBUTIONS = {"ggx": (ggx_d, ggx_area), "beckmann": (beckmann_d, beckmann_area)}

# Azimuths as (cos, sin): the two axes exactly, and a third in the second quadrant.
AXES = ((1, 0), (0, 1))
OBLIQUE = (mpf(-0.6), mpf(0.8))


def directions(ax, ay):
    """Unit directions rounded to binary64.  Rounding leaves them off unit length by an ulp or so;
    the values in the file are for the vector as it stands."""

    def rounded(azimuth, sine, cosine):
        return (nearest(azimuth[0] * sine), nearest(azimuth[1] * sine), nearest(cosine))

    def width(azimuth):
        """Width of the distribution, as a slope, along an azimuth: where its exponent (Beckmann) is
        -1; ax and ay along the axes."""
        return 1 / mp.sqrt((azimuth[0] / mpf(ax)) ** 2 + (azimuth[1] / mpf(ay)) ** 2)

    result = [(0.0, 0.0, 1.0)]
    # Tilts whose tangent is so many widths.
    for azimuth in AXES + (OBLIQUE,):
        for multiple in (mpf("0.1"), mpf("0.3"), mpf(1), mpf(3), mpf(10)):
            tangent = multiple * width(azimuth)
            cosine = 1 / mp.sqrt(1 + tangent**2)
            result.append(rounded(azimuth, tangent * cosine, cosine))
    # Grazing.
    for azimuth in (AXES[0], OBLIQUE):
        for cosine in (mpf("1e-2"), mpf("1e-4"), mpf("1e-8")):
            result.append(rounded(azimuth, mp.sqrt(1 - cosine**2), cosine))
    # Below the horizon: by half a width and by two widths, where some microfacets are still seen
    # edge-on, and far below.
    below = ((OBLIQUE, width(OBLIQUE) / 2), (AXES[0], 2 * width(AXES[0])), (OBLIQUE, mpf(2)))
    for azimuth, tangent in below:
        cosine = 1 / mp.sqrt(1 + tangent**2)
        result.append(rounded(azimuth, cosine, -tangent * cosine))
    return result


def integrate_sphere(d, ax, ay, w):
    """Integral of D(m) max(0, w.m) over the upper hemisphere, in polar coordinates.

    Along an azimuth w.m = sin(theta) along + cos(theta) w_z changes sign at most once: the integral
    stops there if w is above the horizon, and starts there if it is below.  The azimuths are split
    where `along` changes sign, at the axes, and halfway between.
    """
    wx, wy, wz = w

    def along(phi):
        return wx * mp.cos(phi) + wy * mp.sin(phi)

    def at_azimuth(phi):
        cos_phi, sin_phi, a = mp.cos(phi), mp.sin(phi), along(phi)
        if wz <= 0 and a <= 0:
            return mpf(0)
        start = mpf(0) if wz >= 0 else mp.atan2(-wz, a)
        end = mp.pi / 2 if a >= 0 else mp.atan2(wz, -a)

        def integrand(theta):
            s, c = mp.sin(theta), mp.cos(theta)
            return d(ax, ay, s * cos_phi, s * sin_phi, c) * (s * a + c * wz) * s

        return mp.quad(integrand, [start, (2 * start + end) / 3, end], maxdegree=5)

    turn = mp.atan2(wy, wx) + mp.pi / 2
    splits = [i * mp.pi / 4 for i in range(9)] + [(turn + i * mp.pi) % (2 * mp.pi) for i in range(2)]
    return mp.quad(at_azimuth, sorted(set(splits)), maxdegree=4)


def distribution_rows():
    rows = []
    for name, (d, area) in DISTRIBUTIONS.items():
        for ax, ay in ALPHAS:
            for direction in directions(ax, ay):
                x, y, z = (mpf(v) for v in direction)
                assert abs(x * x + y * y + z * z - 1) < mpf(2) ** -50
                values = [f(mpf(ax), mpf(ay), x, y, z) for f in (d, area)]
                assert all(v >= 0 for v in values)
                texts = [out(v if v >= SMALLEST else 0) for v in values]
                inputs = [inp(v) for v in (ax, ay) + direction]
                rows.append(",".join([name] + inputs + texts))

    # Second route: D integrated over the hemisphere, for one anisotropic pair and four directions.
    # w = n gives the normalisation, the integral of D cos(theta) = 1.
    with mp.workdps(15):
        ax, ay = mpf("0.5"), mpf("0.2")
        for d, area in DISTRIBUTIONS.values():
            for theta, phi in ((0, 0), ("0.7", "0.4"), ("1.4", 2), ("1.8", 5)):
                theta, phi = mpf(theta), mpf(phi)
                w = (mp.sin(theta) * mp.cos(phi), mp.sin(theta) * mp.sin(phi), mp.cos(theta))
                expected = mpf(1) if theta == 0 else area(ax, ay, *w)
                assert close(integrate_sphere(d, ax, ay, w), expected, 8), (d.__name__, theta)
    return rows


# --------------------------------------------------------------------------------------------------
# rough_mirror.csv: directional albedo at normal incidence
# --------------------------------------------------------------------------------------------------

HEADER_MIRROR = "alpha,ggx,beckmann,ggx_v_cavity,beckmann_v_cavity"

MIRROR_ALPHAS = (0.05, 0.10, 0.15, 0.20, 0.30, 0.40, 0.50, 0.60, 0.70, 0.80, 0.90, 1.00)


def mirror_albedo(masking, slope_density, alpha):
    """E(0) = integral over t = tan(theta_m)^2 from 0 to 1 of p(t) G1(2 theta_m).

    Light along the normal is reflected at twice the tilt theta_m of the facet, above the horizon for
    theta_m < 45 degrees, that is t < 1.  Seen from the normal nothing is masked, so that G2, be it
    height-correlated or that of V-cavities, is G1 of the reflected direction, masking(alpha, sine,
    cosine) of cos(2 theta_m) = (1 - t) / (1 + t) and sin(2 theta_m) = 2 sqrt(t) / (1 + t).
    With u = t / alpha^2 the density p(t) dt is slope_density(u) du.
    """
    alpha = mpf(alpha)

    def integrand(u):
        t = u * alpha**2
        cosine = (1 - t) / (1 + t)
        if cosine <= 0:
            return mpf(0)
        sine = 2 * mp.sqrt(t) / (1 + t)
        return slope_density(u) * masking(alpha, sine, cosine)

    end = 1 / alpha**2
    # V-cavities hide part of a facet from t = 1/3 on, that is cos(2 theta_m) = 1/2.
    splits = [mpf(0), end / 3, end]
    split = mpf(0.25)
    while split < 3 * end / 4:
        splits.append(split)
        split *= 2
    value, error = mp.quad(integrand, sorted(splits), error=True)
    assert error < mpf(10) ** -40, (alpha, error)
    return value


def smith(area):
    return lambda alpha, sine, cosine: cosine / area(alpha, alpha, sine, mpf(0), cosine)


def v_cavity(alpha, sine, cosine):
    """min(1, 2 cos(theta_m) cos(theta) / (w.m)); w reflects the normal, so that w.m = cos(theta_m)."""
    return min(mpf(1), 2 * cosine)


def mirror_ggx(alpha, masking=smith(ggx_area)):
    return mirror_albedo(masking, lambda u: 1 / (1 + u) ** 2, alpha)


def mirror_beckmann(alpha, masking=smith(beckmann_area)):
    return mirror_albedo(masking, lambda u: mp.exp(-u), alpha)


def mirror_rows():
    rows = []
    for alpha in MIRROR_ALPHAS:
        ggx, beckmann = mirror_ggx(alpha), mirror_beckmann(alpha)
        values = [ggx, beckmann] + [f(alpha, v_cavity) for f in (mirror_ggx, mirror_beckmann)]
        assert 0 < ggx < beckmann <= 1 and 0 < values[2] < values[3] <= 1
        rows.append(",".join([inp(alpha)] + [out(v) for v in values]))

    # Second route: for GGX with alpha = 1 the integrand is (1 - t) / (1 + t)^2; with V-cavities it is
    # 1 / (1 + t)^2 up to 1/3 and 2 (1 - t) / (1 + t)^3 from there.
    assert close(mirror_ggx(1.0), 1 - mp.log(2), 40)
    assert close(mirror_ggx(1.0, v_cavity), mpf(3) / 8, 40)
    return rows


# --------------------------------------------------------------------------------------------------

FILES = (
    ("special.csv", HEADER_SPECIAL, special_rows),
    ("gamma_q.csv", HEADER_GAMMA, gamma_rows),
    ("fresnel.csv", HEADER_FRESNEL, fresnel_rows),
    ("rough_mirror.csv", HEADER_MIRROR, mirror_rows),
    ("distribution.csv", HEADER_DISTRIBUTION, distribution_rows),
)


def main():
    with mp.workdps(DIGITS):
        # Work everything out, and through all assertions, before the first file is touched.
        finished = [(name, header, rows()) for name, header, rows in FILES]
    for name, header, rows in finished:
        write(name, header, rows)


if __name__ == "__main__":
    main()
