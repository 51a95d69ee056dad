// Mouse, touch and pen: grab the body and flick it; drag beside it to move the view.

const MEMORY = 90; // ms of the pointer's last motion that give the throw
const STILL = 150; // ms after which a pointer that has not moved is at rest

class Hand {
  constructor(canvas, view, page) {
    Object.assign(this, { canvas, view, page, held: null, turning: null, motion: [] });
    canvas.addEventListener('pointerdown', (event) => this.press(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.release(event));
    canvas.addEventListener('pointercancel', (event) => this.release(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
  }

  // Point under the pointer in the upright plane through `centre` that faces the eye.
  onPlane(event, centre) {
    const box = this.canvas.getBoundingClientRect(),
      { view } = this;
    const ray = view.ray(event.clientX - box.left, event.clientY - box.top);
    const normal = unit([view.into[0], view.into[1], 0]);
    const along = dot(sub(centre, view.eye), normal) / dot(ray, normal);
    return add(view.eye, scale(ray, along));
  }

  press(event) {
    if (event.button !== 0 || this.held || this.turning) return;
    this.canvas.setPointerCapture(event.pointerId);
    const centre = this.page.position(),
      point = this.onPlane(event, centre);
    const arm = sub(point, centre);
    if (Math.hypot(...arm) > 1.25 * this.view.radius) {
      this.turning = { id: event.pointerId, x: event.clientX, y: event.clientY };
      return;
    }
    this.held = { id: event.pointerId, arm, plane: centre };
    this.motion = [[event.timeStamp, point]];
    this.page.grab();
    this.canvas.classList.add('held');
  }

  move(event) {
    if (this.turning?.id === event.pointerId) {
      this.view.azimuth -= 0.008 * (event.clientX - this.turning.x);
      const tilt = this.view.elevation + 0.006 * (event.clientY - this.turning.y);
      this.view.elevation = Math.min(1.4, Math.max(0.06, tilt));
      Object.assign(this.turning, { x: event.clientX, y: event.clientY });
    }
    if (this.held?.id !== event.pointerId) return;
    const events = event.getCoalescedEvents?.() ?? [];
    for (const each of events.length > 0 ? events : [event])
      this.motion.push([each.timeStamp, this.onPlane(each, this.held.plane)]);
    this.page.hold(sub(this.motion[this.motion.length - 1][1], this.held.arm));
  }

  release(event) {
    if (this.turning?.id === event.pointerId) this.turning = null;
    if (this.held?.id !== event.pointerId) return;
    const { arm } = this.held;
    this.held = null;
    this.canvas.classList.remove('held');
    this.page.letGo(this.velocity(event.timeStamp), arm);
  }

  // Velocity of the pointer over the last moments, m a second of the clock on the wall. An upward
  // flick also throws away from the eye.
  velocity(now) {
    const [to, end] = this.motion[this.motion.length - 1];
    const recent = this.motion.filter(([time]) => to - time < MEMORY);
    const [from, start] =
      recent.length > 1 ? recent[0] : this.motion[Math.max(0, this.motion.length - 2)];
    if (now - to > STILL || from === to) return [0, 0, 0];
    const speed = scale(sub(end, start), 1000 / Math.max(1, to - from));
    const forward = unit([this.view.into[0], this.view.into[1], 0]);
    return add(speed, scale(forward, 0.5 * speed[2]));
  }

  wheel(event) {
    event.preventDefault();
    this.view.zoom = Math.min(4, Math.max(0.4, this.view.zoom * Math.exp(0.0012 * event.deltaY)));
  }
}
