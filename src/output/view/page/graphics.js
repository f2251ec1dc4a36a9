// WebGL: programs, buffers and the window.

const canvas = document.getElementById("scene");
const overlay = document.getElementById("overlay");
const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
const pen = overlay.getContext("2d");

function compiled(vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, `#version 300 es\nprecision highp float;\n${text}`);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  const uniforms = {};
  for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); k++) {
    const { name } = gl.getActiveUniform(program, k);
    uniforms[name] = gl.getUniformLocation(program, name);
  }
  return { program, uniforms };
}

// Squares that are drawn once for each entry of an array with these widths of attributes, after the corners themselves.
function instances(program, names, widths) {
  const array = gl.createVertexArray();
  const [corners, buffer] = [gl.createBuffer(), gl.createBuffer()];
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, corners);
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), gl.STATIC_DRAW);
  const corner = gl.getAttribLocation(program, "corner");
  gl.enableVertexAttribArray(corner);
  gl.vertexAttribPointer(corner, 2, gl.FLOAT, false, 0, 0);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  const stride = widths.reduce((sum, width) => sum + width, 0);
  let start = 0;
  names.forEach((name, k) => {
    const place = gl.getAttribLocation(program, name);
    if (place >= 0) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, widths[k], gl.FLOAT, false, 4 * stride, 4 * start);
      gl.vertexAttribDivisor(place, 1);
    }
    start += widths[k];
  });
  gl.bindVertexArray(null);
  return {
    count: 0,
    stride,
    fill(values) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
      this.count = values.length / stride;
    },
    draw() {
      gl.bindVertexArray(array);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.count);
    },
  };
}

// Gives both canvases the size of their place on the page; true if it has changed.
function fitWindow() {
  const { clientWidth: width, clientHeight: height } = document.getElementById("stage");
  const dense = Math.min(window.devicePixelRatio || 1, 2);
  const changed = camera.window[0] !== width || camera.window[1] !== height || camera.dense !== dense;
  if (changed) {
    for (const one of [canvas, overlay]) [one.width, one.height] = [Math.round(width * dense), Math.round(height * dense)];
    // a place that was chosen stays in view
    if (camera.moved && height > 0) camera.pixels *= height / camera.window[1];
    Object.assign(camera, { window: [Math.max(width, 1), Math.max(height, 1)], dense });
  }
  return changed;
}

function beginDrawing(matrices) {
  gl.viewport(0, 0, canvas.width, canvas.height);
  gl.clearColor(1, 1, 1, 1);
  gl.depthMask(true);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  (dimension === 3 ? gl.enable : gl.disable).call(gl, gl.DEPTH_TEST);
  return matrices;
}

function useProgram({ program, uniforms }, matrices) {
  gl.useProgram(program);
  gl.uniformMatrix4fv(uniforms.view, false, matrices.view);
  gl.uniformMatrix4fv(uniforms.projection, false, matrices.projection);
  // what lies beyond the clip plane: where its normal, as seen, times the point exceeds its offset
  const { axis, part } = state.clip;
  const clips = dimension === 3 && axis !== "none";
  const place = clips ? axisNames.indexOf(axis) : 0;
  const direction = matrices.axes.map((row) => (clips ? row[place] : 0));
  const facing = direction[2] < 0 ? -1 : 1;
  const offset = part * size[place] + dot(direction, matrices.shift);
  gl.uniform4f(uniforms.clip, ...direction.map((value) => facing * value), clips ? facing * offset : 1e30);
}
