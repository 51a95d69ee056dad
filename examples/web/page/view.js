// Three-dimensional view on a canvas: floor, shadow, path of the lowest point, body.

const LIGHT = unit([0.45, -0.35, 0.82]);
const FADES = 6;

class View {
  constructor(canvas) {
    this.canvas = canvas;
    this.draw = canvas.getContext('2d');
    this.azimuth = -1.05;
    this.elevation = 0.36;
    this.zoom = 1;
    this.path = [];
    this.target = [0, 0, 0, 1]; // point that the eye looks at, and how far it is
    this.readTheme();
  }

  // A body of a bounding radius (m), with its mesh.
  show(mesh, radius) {
    this.mesh = mesh;
    this.radius = radius;
    this.path = [];
  }

  readTheme() {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(name).trim();
    this.theme = {
      sky: colour('--sky'),
      floor: colour('--floor'),
      line: colour('--grid'),
      shadow: colour('--shadow'),
      path: colour('--path'),
      ghost: colour('--ghost'),
    };
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const density = Math.min(window.devicePixelRatio || 1, 2);
    const [w, h] = [Math.round(width * density), Math.round(height * density)];
    if (this.canvas.width !== w || this.canvas.height !== h)
      [this.canvas.width, this.canvas.height] = [w, h];
    this.width = width;
    this.height = height;
    this.draw.setTransform(density, 0, 0, density, 0, 0);
  }

  // Camera at a distance from the target. Axes: to the right, up in the picture, into the picture.
  aim(position, follow) {
    const height = Math.max(0, position[2]);
    const goal = [
      position[0],
      position[1],
      Math.max(0.5 * this.radius, 0.5 * height),
      Math.max(6.4 * this.radius, 1.4 * height + 3 * this.radius),
    ];
    this.target = this.target.map((at, i) => at + (goal[i] - at) * follow);
    const [ca, sa, ce, se] = [
      Math.cos(this.azimuth),
      Math.sin(this.azimuth),
      Math.cos(this.elevation),
      Math.sin(this.elevation),
    ];
    this.into = [-ca * ce, -sa * ce, -se];
    this.right = [-sa, ca, 0];
    this.up = cross(this.right, this.into);
    this.distance = this.target[3] * this.zoom * Math.max(1, (0.75 * this.height) / this.width);
    this.eye = sub(this.target, scale(this.into, this.distance));
    this.focus = 1.35 * Math.min(this.height, 1.15 * this.width);
  }

  // Point of the picture, and the distance along the view; null behind the eye.
  project(point) {
    const away = sub(point, this.eye),
      depth = dot(away, this.into);
    if (depth < 0.05 * this.distance) return null;
    const k = this.focus / depth;
    return [
      this.width / 2 + k * dot(away, this.right),
      this.height * 0.54 - k * dot(away, this.up),
      depth,
    ];
  }

  // Direction from the eye through a point of the picture.
  ray(x, y) {
    const across = (x - this.width / 2) / this.focus,
      down = (y - this.height * 0.54) / this.focus;
    return unit(add(this.into, add(scale(this.right, across), scale(this.up, -down))));
  }

  trace(points) {
    this.path.push(...points);
    if (this.path.length > 2400) this.path.splice(0, this.path.length - 2400);
  }

  render(body, ghost) {
    this.draw.fillStyle = this.theme.sky;
    this.draw.fillRect(0, 0, this.width, this.height);
    this.drawFloor();
    this.drawPath();
    if (ghost) this.drawShadow(ghost, 0.4);
    this.drawShadow(body, 1);
    if (ghost) this.drawGhost(ghost);
    this.drawBody(body);
  }

  // Width of a square of the floor: 1, 2 or 5 times a power of ten, near the radius.
  square() {
    const power = 10 ** Math.floor(Math.log10(this.radius)),
      digit = this.radius / power;
    return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
  }

  drawFloor() {
    const { draw, theme } = this,
      horizon = this.height * 0.54 - this.focus * Math.tan(this.elevation);
    const glow = draw.createLinearGradient(0, Math.max(0, horizon), 0, this.height);
    glow.addColorStop(0, theme.sky);
    glow.addColorStop(1, theme.floor);
    draw.fillStyle = glow;
    draw.fillRect(0, Math.max(0, horizon), this.width, this.height);
    const step = this.square(),
      reach = 16,
      rings = Array.from({ length: FADES }, () => new Path2D());
    const [cx, cy] = [Math.round(this.target[0] / step), Math.round(this.target[1] / step)];
    for (let line = -reach; line <= reach; line += 1) {
      for (let part = -reach; part < reach; part += 1) {
        this.addLine(
          rings,
          [
            [cx + line, cy + part],
            [cx + line, cy + part + 1],
          ],
          step,
          reach,
        );
        this.addLine(
          rings,
          [
            [cx + part, cy + line],
            [cx + part + 1, cy + line],
          ],
          step,
          reach,
        );
      }
    }
    draw.strokeStyle = theme.line;
    draw.lineWidth = 1;
    rings.forEach((ring, i) => {
      draw.globalAlpha = (1 - i / FADES) ** 1.5;
      draw.stroke(ring);
    });
    draw.globalAlpha = 1;
  }

  addLine(rings, ends, step, reach) {
    const middle = [(ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2];
    const away =
      Math.hypot(middle[0] - this.target[0] / step, middle[1] - this.target[1] / step) / reach;
    if (away >= 1) return;
    const [a, b] = ends.map(([x, y]) => this.project([x * step, y * step, 0]));
    if (!a || !b) return;
    const ring = rings[Math.floor(away * FADES)];
    ring.moveTo(a[0], a[1]);
    ring.lineTo(b[0], b[1]);
  }

  // Path of the lowest point where it touches the floor; the oldest part fades.
  drawPath() {
    const { draw, path } = this,
      parts = 8;
    draw.strokeStyle = this.theme.path;
    draw.lineWidth = 1.6;
    draw.lineJoin = 'round';
    for (let part = 0; part < parts; part += 1) {
      const [first, last] = [
        Math.floor((part * path.length) / parts),
        Math.ceil(((part + 1) * path.length) / parts),
      ];
      draw.globalAlpha = 0.12 + 0.88 * (part / (parts - 1)) ** 1.5;
      draw.beginPath();
      let pen = false;
      for (const [x, y, gap] of path.slice(first, last + 1)) {
        const at = gap < 0.01 * this.radius ? this.project([x, y, 0]) : null;
        if (at && pen) draw.lineTo(at[0], at[1]);
        else if (at) draw.moveTo(at[0], at[1]);
        pen = Boolean(at);
      }
      draw.stroke();
    }
    draw.globalAlpha = 1;
  }

  drawShadow({ position, rotate }, strength) {
    const cast = this.mesh.hull.map((corner) => {
      const p = add(position, rotate(corner));
      return [p[0] - (LIGHT[0] / LIGHT[2]) * p[2], p[1] - (LIGHT[1] / LIGHT[2]) * p[2]];
    });
    const edge = outline(cast),
      middle = scale(
        edge.reduce((a, [x, y]) => [a[0] + x, a[1] + y, 0], [0, 0, 0]),
        1 / edge.length,
      );
    const height = Math.max(0, position[2]) / this.radius,
      layers = 12;
    this.draw.fillStyle = this.theme.shadow;
    for (let layer = 0; layer < layers; layer += 1) {
      const wide = 1 + (layer - 5) * (0.012 + 0.014 * height);
      const corners = edge.map(([x, y]) =>
        this.project([middle[0] + (x - middle[0]) * wide, middle[1] + (y - middle[1]) * wide, 0]),
      );
      if (corners.some((corner) => !corner)) return;
      this.draw.globalAlpha = (strength * 0.075) / (1 + 0.25 * height);
      this.fill(corners);
    }
    this.draw.globalAlpha = 1;
  }

  fill(corners) {
    this.draw.beginPath();
    corners.forEach(([x, y], i) => (i ? this.draw.lineTo(x, y) : this.draw.moveTo(x, y)));
    this.draw.closePath();
    this.draw.fill();
  }

  drawBody({ position, rotate }) {
    const { draw } = this;
    draw.lineWidth = 0.8;
    draw.lineJoin = 'round';
    for (const { corners, normal, colour } of this.mesh.faces) {
      const places = corners.map((corner) => add(position, rotate(corner))),
        out = rotate(normal);
      if (dot(out, sub(places[0], this.eye)) >= 0) continue;
      const picture = places.map((place) => this.project(place));
      if (picture.some((corner) => !corner)) continue;
      draw.fillStyle = draw.strokeStyle = this.lit(colour, out);
      this.fill(picture);
      draw.stroke(); // closes the gaps that smoothing leaves between neighbours
    }
    for (const mark of this.mesh.marks) this.drawMark(mark, position, rotate);
  }

  drawMark({ line, patch, normal, width, colour }, position, rotate) {
    const places = (line ?? patch).map((corner) => add(position, rotate(corner))),
      out = rotate(normal);
    if (dot(out, sub(places[0], this.eye)) >= 0) return;
    const picture = places.map((place) => this.project(place));
    if (picture.some((corner) => !corner)) return;
    this.draw.fillStyle = this.draw.strokeStyle = this.lit(colour, out);
    if (patch) return this.fill(picture);
    this.draw.lineWidth = Math.max(1, (width * this.focus) / picture[0][2]);
    this.draw.lineCap = 'round';
    this.draw.beginPath();
    picture.forEach(([x, y], i) => (i ? this.draw.lineTo(x, y) : this.draw.moveTo(x, y)));
    this.draw.stroke();
  }

  // Colour under the light: a part from everywhere, a part by the angle, and a highlight.
  lit(colour, normal) {
    const bright = 0.68 + 0.08 * normal[2] + 0.38 * Math.max(0, dot(normal, LIGHT));
    const half = unit(sub(LIGHT, this.into)),
      shine = 48 * Math.max(0, dot(normal, half)) ** 20;
    const [r, g, b] = colour.map((c) => Math.min(255, Math.round(c * bright + shine)));
    return `rgb(${r},${g},${b})`;
  }

  drawGhost({ position, rotate }) {
    const flat = this.mesh.hull
      .map((corner) => this.project(add(position, rotate(corner))))
      .filter(Boolean);
    const edge = outline(flat);
    if (edge.length < 3) return;
    this.draw.fillStyle = this.draw.strokeStyle = this.theme.ghost;
    this.draw.globalAlpha = 0.22;
    this.fill(edge);
    this.draw.globalAlpha = 1;
    this.draw.lineWidth = 1.5;
    this.draw.setLineDash([5, 4]);
    this.draw.stroke();
    this.draw.setLineDash([]);
  }
}

// Convex hull of points of a plane, counter-clockwise: A. M. Andrew, Inf. Process. Lett. 9, 216
// (1979).
function outline(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (list) => {
    const kept = [];
    for (const p of list) {
      const turns = () => {
        const [a, b] = kept.slice(-2);
        return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
      };
      while (kept.length > 1 && turns() <= 0) kept.pop();
      kept.push(p);
    }
    return kept.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

// Rotation by a unit quaternion x, y, z, w.
function rotation([x, y, z, w]) {
  const axis = [x, y, z];
  return (v) => {
    const t = scale(cross(axis, v), 2);
    return add(v, add(scale(t, w), cross(axis, t)));
  };
}
