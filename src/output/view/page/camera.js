// From the box to the window: a plane that is moved and scaled in 2D; in 3D a perspective view that turns about a point.
// Matrices are columns one after the other, as WebGL takes them.

const camera = {
  // in 2D the middle of the window and pixels per length, in 3D what it turns about and the distance
  target: size.map((length) => length / 2),
  pixels: 1,
  azimuth: 0.45,
  elevation: 0.32,
  distance: 1,
  moved: false,
  window: [1, 1],
};
const opening = Math.tan((14 * Math.PI) / 180);
const margins = { left: 64, right: 116, top: 44, bottom: 46 };

const diagonal = Math.hypot(...size);
const unit = (axis) => [0, 1, 2].map((other) => (other === axis ? 1 : 0));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const along = (a, direction, distance) => a.map((value, axis) => value + distance * direction[axis]);

// Shows the whole box, times so many.
function fitCamera(times = 1) {
  const [width, height] = camera.window;
  camera.target = size.map((length) => length / 2);
  camera.moved = false;
  if (dimension === 2) {
    const room = [width - margins.left - margins.right, height - margins.top - margins.bottom];
    camera.pixels = Math.max(1e-9, Math.min(room[0] / size[0], room[1] / size[1]) / times);
    camera.target[0] += (margins.right - margins.left) / 2 / camera.pixels;
    camera.target[1] += (margins.top - margins.bottom) / 2 / camera.pixels;
  } else {
    const room = [0.5 * width - margins.right, 0.5 * height - 30];
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => size.map((length, axis) => (bits & (1 << axis) ? length : 0)));
    const fits = ({ x, y, depth }) => depth > 0 && Math.abs(x - 0.5 * width) * times < room[0] && Math.abs(y - 0.5 * height) * times < room[1];
    camera.distance = 0.6 * diagonal;
    while (camera.distance < 100 * diagonal && !corners.every((corner) => fits(project(corner)))) camera.distance *= 1.02;
  }
}

// Rows: the directions in space that point right, up and to the viewer.
function cameraAxes() {
  if (dimension === 2) return [unit(0), unit(1), unit(2)];
  const [right, above] = [unit(across), unit(up)];
  const front = cross(right, above);
  const [ca, sa, ce, se] = [Math.cos(camera.azimuth), Math.sin(camera.azimuth), Math.cos(camera.elevation), Math.sin(camera.elevation)];
  const turned = right.map((value, k) => ca * value - sa * front[k]);
  const level = right.map((value, k) => sa * value + ca * front[k]);
  return [turned, above.map((value, k) => ce * value - se * level[k]), above.map((value, k) => se * value + ce * level[k])];
}

function cameraMatrices() {
  const axes = cameraAxes();
  const back = dimension === 2 ? 0 : camera.distance;
  const shift = axes.map((axis, row) => -dot(axis, camera.target) - (row === 2 ? back : 0));
  const view = [0, 1, 2].flatMap((axis) => [axes[0][axis], axes[1][axis], axes[2][axis], 0]).concat([...shift, 1]);
  const [width, height] = camera.window;
  if (dimension === 2) {
    const scale = [(2 * camera.pixels) / width, (2 * camera.pixels) / height];
    return { axes, shift, view, projection: [scale[0], 0, 0, 0, 0, scale[1], 0, 0, 0, 0, -1e-3, 0, 0, 0, 0, 1] };
  }
  // as far away as may be: the nearer, the coarser are depths
  const reach = (state.images === "around" ? 2.6 : 0.9) * diagonal + Math.hypot(...camera.target.map((value, axis) => value - size[axis] / 2));
  const near = Math.max(camera.distance - reach, 0.02 * diagonal);
  const far = camera.distance + reach;
  const depth = [-(far + near) / (far - near), (-2 * far * near) / (far - near)];
  const projection = [height / width / opening, 0, 0, 0, 0, 1 / opening, 0, 0, 0, 0, depth[0], -1, 0, 0, depth[1], 0];
  return { axes, shift, view, projection };
}

// Where a point of the space is in the window, its depth, and the pixels of a length there.
function project(point, { axes, shift } = cameraMatrices()) {
  const [width, height] = camera.window;
  const [x, y, z] = axes.map((axis, row) => dot(axis, point) + shift[row]);
  const pixels = dimension === 2 ? camera.pixels : height / 2 / opening / -z;
  return { x: width / 2 + x * pixels, y: height / 2 - y * pixels, depth: -z, pixels };
}

// The point of a plane under a place in the window, in 2D.
const planePoint = (x, y) => [
  camera.target[0] + (x - camera.window[0] / 2) / camera.pixels,
  camera.target[1] - (y - camera.window[1] / 2) / camera.pixels,
];

function moveCamera(dx, dy) {
  const pixels = dimension === 2 ? camera.pixels : camera.window[1] / 2 / opening / camera.distance;
  const [right, above] = cameraAxes();
  camera.target = along(along(camera.target, right, -dx / pixels), above, dy / pixels);
  camera.moved = true;
}

function turnCamera(dx, dy) {
  camera.azimuth -= 0.008 * dx;
  camera.elevation = Math.min(Math.max(camera.elevation + 0.008 * dy, -1.55), 1.55);
  camera.moved = true;
}

// Comes nearer by a factor; in 2D what is under the pointer stays there.
function zoomCamera(factor, x, y) {
  camera.moved = true;
  if (dimension === 3) {
    camera.distance = Math.min(Math.max(camera.distance / factor, 0.05 * diagonal), 30 * diagonal);
    return;
  }
  const before = planePoint(x, y);
  camera.pixels *= factor;
  const after = planePoint(x, y);
  camera.target = [camera.target[0] + before[0] - after[0], camera.target[1] + before[1] - after[1], 0];
}
