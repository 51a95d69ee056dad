"""Makes free_rotation.csv: torque-free rotations of bodies with three different moments.

    python3 tests/data/free_rotation.py > tests/data/free_rotation.csv

The equations of motion are integrated by Taylor series in decimal arithmetic of 44 digits, without
elliptic functions of time: M' = M x (M/I) for the angular momentum M in body axes, q' = q w/2 with
w = M/I. The momentum M is periodic. So the orientation after n periods and a rest is
q(0) (q(0)^-1 q(T))^n q(0)^-1 q(rest), where T and the rest are integrated. The period comes from
Gauss's arithmetic-geometric mean. Each case checks that M returns after a period, within 1e-30.
Moments, start, momentum and time are the exact values of the printed f64.
"""

import math
from decimal import Decimal as D, getcontext
from operator import mul

getcontext().prec = 44
ORDER = 36
# rad of the fastest rotation for each step: the series converges beyond 1.5.
PART = D("0.2")


def pi():
    a, b, t, p = D(1), 1 / D(2).sqrt(), D("0.25"), D(1)
    for _ in range(8):
        a, b, t, p = (a + b) / 2, (a * b).sqrt(), t - p * ((a - b) / 2) ** 2, 2 * p
    return (a + b) ** 2 / (4 * t)


def conv(a, b):
    return sum(map(mul, a, reversed(b)))


def step(m, q, j, h):
    """Taylor step of momentum (body axes) and quaternion w, x, y, z."""
    ms, ws, qs = [[x] for x in m], [[x * r] for x, r in zip(m, j)], [[x] for x in q]
    for n in range(ORDER):
        d = [conv(ms[1], ws[2]) - conv(ms[2], ws[1]),
             conv(ms[2], ws[0]) - conv(ms[0], ws[2]),
             conv(ms[0], ws[1]) - conv(ms[1], ws[0])]
        (w, x, y, z), (a, b, c) = qs, ws
        e = [-conv(x, a) - conv(y, b) - conv(z, c),
             conv(w, a) + conv(y, c) - conv(z, b),
             conv(w, b) + conv(z, a) - conv(x, c),
             conv(w, c) + conv(x, b) - conv(y, a)]
        for i in range(3):
            ms[i].append(d[i] / (n + 1))
            ws[i].append(ms[i][-1] * j[i])
        for i in range(4):
            qs[i].append(e[i] / (2 * (n + 1)))

    def at(series):
        total = D(0)
        for coefficient in reversed(series):
            total = total * h + coefficient
        return total

    return [at(s) for s in ms], [at(s) for s in qs]


def integrate(m, q, j, t):
    fastest = sum(x * x for x in m).sqrt() * max(j)
    steps = int(t * fastest / PART) + 1
    for _ in range(steps):
        m, q = step(m, q, j, t / steps)
    return m, unit(q)


def times(p, q):
    a, b, c, d = p
    w, x, y, z = q
    return [a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y,
            a * y + c * w + d * x - b * z, a * z + d * w + b * y - c * x]


def unit(q):
    n = sum(x * x for x in q).sqrt()
    return [x / n for x in q]


def conj(q):
    return [q[0], -q[1], -q[2], -q[3]]


def power(q, n):
    r = [D(1), D(0), D(0), D(0)]
    while n:
        if n & 1:
            r = unit(times(r, q))
        q, n = unit(times(q, q)), n >> 1
    return r


def turn(q, v):
    return times(times(q, [D(0)] + v), conj(q))[1:]


def period(m, j):
    order = sorted(range(3), key=lambda i: j[i])
    b = order[1]
    square = sum(x * x for x in m)
    excess = sum(x * x * (r - j[b]) for x, r in zip(m, j))
    a, c = (order[2], order[0]) if excess > 0 else (order[0], order[2])
    e_c = m[a] ** 2 * (j[a] - j[c]) + m[b] ** 2 * (j[b] - j[c])
    k = (excess * (j[a] - j[c]) / ((j[a] - j[b]) * e_c)).sqrt()
    rate = (e_c * (j[a] - j[b])).sqrt()
    x, y = D(1), k
    while abs(x - y) > D("1e-43"):
        x, y = (x + y) / 2, (x * y).sqrt()
    return 2 * pi() / (x * rate), excess / (square * j[b])


def reference(moments, q, momentum, t):
    j = [1 / D(x) for x in moments]
    q = unit([D(x) for x in q])
    m = turn(conj(q), [D(x) for x in momentum])
    t = D(t)
    whole, distance = period(m, j)
    n = int(t / whole)
    end = q
    if n:
        m_after, q_after = integrate(m, q, j, whole)
        off = max(abs(x - y) for x, y in zip(m, m_after)) / max(map(abs, m))
        assert off < D("1e-30") / abs(distance), off
        end = times(q, power(times(conj(q), q_after), n))
    _, rest = integrate(m, q, j, t - n * whole)
    return unit(times(end, times(conj(q), rest))), distance, n


def f64_unit(q):
    n = math.sqrt(sum(x * x for x in q))
    return [x / n for x in q]


def momentum_of(q, m):
    """The f64 momentum in world axes that is nearest to m in body axes."""
    return [float(x) for x in turn(unit([D(x) for x in q]), [D(x) for x in m])]


def revolutions(moments, momentum, n):
    """The f64 time of about n revolutions about the momentum."""
    size = math.sqrt(sum(x * x for x in momentum))
    return n * 2 * math.pi * sorted(moments)[1] / size


def near_separatrix(moments, m_c, distance):
    """Momentum in body axes of length 1 with 2 T I2/L^2 - 1 = distance, for sorted moments."""
    i1, i2, i3 = map(D, moments)
    m_c, distance = D(m_c), D(distance)
    # m1^2 (i2/i1 - 1) - m3^2 (1 - i2/i3) = distance
    m_a = ((distance + m_c ** 2 * (1 - i2 / i3)) / (i2 / i1 - 1)).sqrt()
    return [m_a, (1 - m_a ** 2 - m_c ** 2).sqrt(), m_c]


QUATS = [(0.9, 0.1, -0.3, 0.2), (0.2, -0.7, 0.4, 0.5), (-0.3, 0.6, 0.1, -0.8), (1.0, 0.0, 0.0, 0.0)]

GENERIC = [
    ((1.0, 1.6, 2.3), (0.31, -0.42, 0.77)),
    ((2.3, 1.1, 1.9), (-1.3, 0.2, 0.6)),
    ((0.013, 0.021, 0.0103), (0.004, 0.03, -0.011)),
    ((5.5, 3.25, 2.75), (1.5, -2.5, 3.75)),
    ((1.0, 40.0, 40.7), (0.02, 0.9, -1.1)),
    ((10.0, 12.0, 21.9), (-7.0, 3.0, 2.0)),
]
SEPARATRIX = [(1.0, 1.6, 2.3), (0.7, 0.75, 1.4)]
DISTANCES = ["1e-2", "1e-4", "1e-6", "1e-8", "1e-10", "1e-12"]
NEARLY_EQUAL = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13]


def cases():
    for k, (moments, momentum) in enumerate(GENERIC):
        for n in (1, 100, 1000):
            yield "generic", moments, QUATS[k % 4], momentum, n
    for k, moments in enumerate(SEPARATRIX):
        for distance in DISTANCES:
            for sign in ("", "-"):
                m = near_separatrix(moments, "0.3", sign + distance)
                q = f64_unit(QUATS[k])
                yield "separatrix", moments, QUATS[k], momentum_of(q, m), 1000
    for d in NEARLY_EQUAL:
        for moments in ((1.0, 1.0 + d, 1.7), (1.0, 1.6, 1.6 * (1.0 + d))):
            yield "nearly equal", moments, QUATS[1], (0.4, -0.8, 0.5), 1000
        # The period is longer than the flight, so that all of it is integrated.
        if d >= 1e-12:
            moments = (1.0 + 2.0 * d, 1.0, 1.0 + d)
            yield "three nearly equal", moments, QUATS[2], (0.3, 0.6, -0.7), 1000
    # Next to the plane of two nearly equal axes, where the path is long and narrow.
    for d, n in ((1e-2, 1000), (1e-4, 1000), (1e-6, 100), (1e-9, 10), (1e-12, 10)):
        width = math.sqrt(d)
        for moments in ((1.0, 1.0 + d, 1.7), (1.0 + d, 1.0, 0.6)):
            m = (0.9, 0.3, 0.2 * width)
            yield "narrow", moments, QUATS[0], momentum_of(f64_unit(QUATS[0]), m), n
    for tilt in (1e-3, 1e-9):
        for axis in range(3):
            m = [tilt * 0.7, -tilt, tilt * 0.4]
            m[axis] = -1.0 if tilt < 1e-6 else 1.0
            q = f64_unit(QUATS[1])
            n = 1000 if axis != 1 or tilt > 1e-6 else 5
            yield "axis", (1.1, 1.4, 2.2), QUATS[1], momentum_of(q, m), n


def main():
    print("kind,ix,iy,iz,qw,qx,qy,qz,lx,ly,lz,t,distance,periods,w,x,y,z")
    for kind, moments, q, momentum, n in cases():
        q = f64_unit(q)
        t = revolutions(moments, momentum, n)
        end, distance, periods = reference(moments, q, momentum, t)
        numbers = [repr(float(x)) for x in (*moments, *q, *momentum, t)]
        print(",".join([kind, *numbers, f"{distance:.1e}", str(periods),
                        *(f"{x:.20f}" for x in end)]), flush=True)


if __name__ == "__main__":
    main()
