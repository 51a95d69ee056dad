// Shapes of the bodies in body axes. They are convex, so that the faces that point to the eye hide
// the others.

const GOLD = [214, 168, 72],
  SILVER = [204, 209, 217],
  IVORY = [240, 232, 214],
  INK = [44, 48, 60];
const RED = [198, 70, 62],
  BLUE = [58, 104, 170],
  SAND = [222, 190, 150],
  WOOD = [170, 112, 66],
  GREEN = [86, 140, 104];

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const unit = (a) => scale(a, 1 / Math.hypot(...a));

// A face has corners, an outward normal and a colour. A mark is a line or a patch on a face.
const face = (corners, normal, colour) => ({ corners, normal: unit(normal), colour });

function circle(x, radius, count, turn = 0) {
  return Array.from({ length: count }, (_, i) => {
    const angle = (2 * Math.PI * i) / count + turn;
    return [x, radius * Math.cos(angle), radius * Math.sin(angle)];
  });
}

// Cylinder about body x: heads at +x, tails at -x.
function coinMesh(radius, thickness, rim) {
  const count = 64,
    half = thickness / 2;
  const [front, back] = [circle(half, radius, count), circle(-half, radius, count)];
  const faces = [face(front, [1, 0, 0], GOLD), face([...back].reverse(), [-1, 0, 0], SILVER)];
  for (let i = 0; i < count; i += 1) {
    const next = (i + 1) % count,
      angle = (2 * Math.PI * (i + 0.5)) / count;
    const normal = [0, Math.cos(angle), Math.sin(angle)];
    faces.push(
      face(
        [back[i], back[next], front[next], front[i]],
        normal,
        i % 2 ? rim : rim.map((c) => c * 0.93),
      ),
    );
  }
  const letter = (x, strokes) =>
    strokes.map((line) => line.map(([y, z]) => [x, y * radius, z * radius]));
  const heads = [
    [
      [-0.24, -0.36],
      [-0.24, 0.36],
    ],
    [
      [0.24, -0.36],
      [0.24, 0.36],
    ],
    [
      [-0.24, 0],
      [0.24, 0],
    ],
  ];
  const tails = [
    [
      [-0.3, 0.36],
      [0.3, 0.36],
    ],
    [
      [0, 0.36],
      [0, -0.36],
    ],
  ];
  const marks = [
    ...letter(half, heads).map((line) => ({
      line,
      normal: [1, 0, 0],
      width: 0.075 * radius,
      colour: [122, 86, 20],
    })),
    ...letter(-half, tails).map((line) => ({
      line,
      normal: [-1, 0, 0],
      width: 0.075 * radius,
      colour: [92, 98, 110],
    })),
    {
      line: [...circle(half, 0.84 * radius, 48), [half, 0.84 * radius, 0]],
      normal: [1, 0, 0],
      width: 0.03 * radius,
      colour: [150, 110, 34],
    },
    {
      line: [...circle(-half, 0.84 * radius, 48), [-half, 0.84 * radius, 0]],
      normal: [-1, 0, 0],
      width: 0.03 * radius,
      colour: [122, 128, 140],
    },
  ];
  return { faces, marks, hull: [...front, ...back] };
}

// Ellipsoid in bands of longitude and latitude. `paint` takes the indices of both, and the height
// on the unit ball.
function ellipsoidMesh(middle, axes, paint) {
  const around = 40,
    along = 24,
    faces = [],
    hull = [];
  const point = (i, j) => {
    const [phi, theta] = [(2 * Math.PI * i) / around, (Math.PI * j) / along];
    return [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
  };
  const placed = (p) => add(middle, [p[0] * axes[0], p[1] * axes[1], p[2] * axes[2]]);
  for (let j = 0; j < along; j += 1) {
    for (let i = 0; i < around; i += 1) {
      const corners = [point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)];
      const centre = scale(corners.reduce(add), 0.25);
      const normal = [centre[0] / axes[0], centre[1] / axes[1], centre[2] / axes[2]];
      faces.push(face(corners.map(placed), normal, paint(i, j, centre[2])));
      hull.push(placed(corners[0]));
    }
  }
  return { faces, marks: [], hull };
}

// Places of the pips on a side, in a square from -1 to 1.
const PIPS = [
  [[0, 0]],
  [
    [-1, -1],
    [1, 1],
  ],
  [
    [-1, -1],
    [0, 0],
    [1, 1],
  ],
  [
    [-1, -1],
    [-1, 1],
    [1, -1],
    [1, 1],
  ],
  [
    [-1, -1],
    [-1, 1],
    [0, 0],
    [1, -1],
    [1, 1],
  ],
  [
    [-1, -1],
    [-1, 0],
    [-1, 1],
    [1, -1],
    [1, 0],
    [1, 1],
  ],
];

// Cube with bevelled edges. Opposite sides add up to 7: +x 1, +y 2, +z 3.
function dieMesh(edge, bevel) {
  const half = edge / 2,
    flat = half - bevel,
    faces = [],
    marks = [];
  const at = (axis, a, b, c) => {
    const p = [0, 0, 0];
    p[axis] = a;
    p[(axis + 1) % 3] = b;
    p[(axis + 2) % 3] = c;
    return p;
  };
  for (let axis = 0; axis < 3; axis += 1) {
    for (const sign of [1, -1]) {
      const normal = at(axis, sign, 0, 0),
        top = sign * half;
      faces.push(
        face(
          [
            [-1, -1],
            [1, -1],
            [1, 1],
            [-1, 1],
          ].map(([b, c]) => at(axis, top, b * flat, c * flat)),
          normal,
          IVORY,
        ),
      );
      const pips = PIPS[sign > 0 ? axis : 5 - axis];
      for (const [b, c] of pips) {
        const patch = circle(0, 0.095 * edge, 14).map(([, y, z]) =>
          at(axis, top, b * 0.24 * edge + y, c * 0.24 * edge + z),
        );
        marks.push({ patch, normal, colour: INK });
      }
      for (const other of [1, -1]) {
        const slope = at(axis, sign, other, 0);
        faces.push(
          face(
            [
              at(axis, top, other * flat, -flat),
              at(axis, top, other * flat, flat),
              at(axis, sign * flat, other * half, flat),
              at(axis, sign * flat, other * half, -flat),
            ],
            slope,
            IVORY,
          ),
        );
      }
    }
  }
  for (const x of [1, -1])
    for (const y of [1, -1])
      for (const z of [1, -1]) {
        const corners = [
          [x * half, y * flat, z * flat],
          [x * flat, y * half, z * flat],
          [x * flat, y * flat, z * half],
        ];
        faces.push(face(corners, [x, y, z], IVORY));
      }
  return { faces, marks, hull: faces.flatMap((f) => f.corners) };
}

const BODIES = [
  {
    name: 'Coin',
    faces: ['heads', 'tails', 'edge'],
    rate: 1,
    mesh: () => coinMesh(0.5, 0.03, GOLD),
    starts: ['spins on its rim', 'rolls', 'is dropped'],
  },
  {
    name: 'Thick coin',
    faces: ['heads', 'tails', 'edge'],
    rate: 0.25,
    mesh: () => coinMesh(0.012, 0.012 * Math.SQRT1_2, SILVER),
    starts: ['spins on its rim', 'rolls', 'is dropped'],
  },
  {
    name: 'Ball',
    faces: [],
    rate: 0.5,
    mesh: () =>
      ellipsoidMesh([0, 0, 0], [0.0286, 0.0286, 0.0286], (i, j, z) =>
        Math.abs(z) < 0.5 ? RED : IVORY,
      ),
    starts: ['spins', 'skids, then rolls', 'is dropped with a spin'],
  },
  {
    name: 'Die',
    faces: ['1', '2', '3', '4', '5', '6'],
    rate: 0.25,
    mesh: () => dieMesh(0.016, 0.0015),
    starts: ['spins on a corner', 'tips over', 'is dropped'],
  },
  {
    name: 'Tippe top',
    faces: [],
    rate: 0.5,
    mesh: () =>
      ellipsoidMesh([0, 0, 0.006], [0.02, 0.02, 0.02], (i, j, z) =>
        z > 0.5 ? RED : z < 0 ? BLUE : i % 20 < 10 ? IVORY : SAND,
      ),
    starts: ['spins', 'rolls', 'is dropped'],
  },
  {
    name: 'Egg',
    faces: [],
    rate: 0.5,
    mesh: () =>
      ellipsoidMesh([0, 0, 0], [0.02, 0.02, 0.03], (i, j, z) =>
        z > 0.75 ? RED : z < -0.75 ? BLUE : i % 20 < 10 ? IVORY : SAND,
      ),
    starts: ['spins on its side', 'rolls', 'is dropped'],
  },
  {
    name: 'Rattleback',
    faces: [],
    rate: 1,
    mesh: () =>
      ellipsoidMesh([0, 0, 0], [0.2, 0.03, 0.02], (i, j, z) =>
        i % 20 < 2 || i % 20 > 17 ? SAND : i % 20 < 10 ? WOOD : GREEN,
      ),
    starts: ['spins', 'tips', 'is dropped'],
  },
];
