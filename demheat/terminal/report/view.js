// Draws a box of voxels by marching rays through two textures: which colour each voxel has, and a value on some of them.
// Turned by dragging, zoomed by the wheel; three planes cut it. Without WebGL 2 the picture below it stays.
"use strict";
const VERTEX = `#version 300 es
in vec2 at; out vec2 place; void main() { place = at; gl_Position = vec4(at, 0.0, 1.0); }`;
const FRAGMENT = `#version 300 es
precision highp float; precision highp sampler3D;
uniform sampler3D kinds, values;
uniform mat3 turn; uniform vec3 size, low, high, cells; uniform vec4 colours[16];
uniform float zoom, ratio; uniform bool valued;
in vec2 place; out vec4 shade;
int kind(vec3 p) {
  if (any(lessThan(p, vec3(0.0))) || any(greaterThanEqual(p, size))) return 255;
  return int(texture(kinds, p / size).r * 255.0 + 0.5);
}
float seen(vec3 p) { int k = kind(p); return k < 16 ? colours[k].a : 0.0; }
vec3 map(float v) {
  vec3 a = vec3(0.0, 0.0, 0.08), b = vec3(0.58, 0.13, 0.40), c = vec3(0.97, 0.55, 0.15), d = vec3(0.99, 1.0, 0.75);
  return v < 0.4 ? mix(a, b, v / 0.4) : v < 0.75 ? mix(b, c, (v - 0.4) / 0.35) : mix(c, d, (v - 0.75) / 0.25);
}
void main() {
  float span = length(size);
  vec3 from = turn * vec3(place.x * ratio * span * zoom, place.y * span * zoom, 2.0 * span) + 0.5 * size;
  vec3 along = turn * vec3(0.0, 0.0, -1.0), one = (low - from) / along, two = (high - from) / along;
  vec3 near = min(one, two), far = max(one, two);
  float begin = max(max(near.x, near.y), near.z), end = min(min(far.x, far.y), far.z);
  vec3 paper = vec3(1.0);
  vec3 a = (vec3(0.0) - from) / along, b = (size - from) / along, n0 = min(a, b), f0 = max(a, b);
  float first = max(max(n0.x, n0.y), n0.z), last = min(min(f0.x, f0.y), f0.z);
  if (first < last) {
    vec3 p = from + along * first, q = from + along * last;
    vec3 e = min(abs(p), abs(size - p)), g = min(abs(q), abs(size - q));
    float rim = 0.004 * span * zoom;
    if (int(e.x < rim) + int(e.y < rim) + int(e.z < rim) > 1) paper = vec3(0.3);
    else if (int(g.x < rim) + int(g.y < rim) + int(g.z < rim) > 1) paper = vec3(0.75);
  }
  shade = vec4(paper, 1.0);
  if (begin >= end) return;
  float pace = 0.5 * min(min(size.x / cells.x, size.y / cells.y), size.z / cells.z), t = begin + 1e-4 * pace;
  for (int i = 0; i < 1600 && t < end; i++, t += pace) {
    vec3 p = from + along * t;
    if (seen(p) < 0.5) continue;
    vec3 normal = vec3(0.0), h = size / cells;
    if (t < begin + pace) { normal = vec3(equal(near, vec3(begin))) * -sign(along); }
    else for (int x = -2; x < 3; x++) for (int y = -2; y < 3; y++) for (int z = -2; z < 3; z++) {
      vec3 o = vec3(x, y, z); normal -= o * seen(p + o * h);
    }
    float light = length(normal) > 0.0 ? 0.35 + 0.65 * abs(dot(normalize(normal), normalize(along - 0.4 * turn[0] - 0.5 * turn[1]))) : 0.6;
    vec3 own = colours[kind(p)].rgb;
    if (valued) { float v = texture(values, p / size).r; own = map(clamp((v * 255.0 - 1.0) / 254.0, 0.0, 1.0)); light = 0.5 + 0.5 * light; }
    shade = vec4(own * light, 1.0);
    return;
  }
}`;
async function bytes(text) {
  const raw = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Uint8Array(await new Response(new Blob([raw]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
}
async function view(root, data) {
  const canvas = root.querySelector("canvas"), gl = canvas.getContext("webgl2", { preserveDrawingBuffer: true });
  if (!gl || typeof DecompressionStream === "undefined") return;
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text); gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) { console.error(gl.getShaderInfoLog(shader)); return; }
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program); gl.useProgram(program);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
  gl.enableVertexAttribArray(0); gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  const at = (name) => gl.getUniformLocation(program, name);
  function texture(unit, shape, content, filter) {
    gl.activeTexture(gl.TEXTURE0 + unit); gl.bindTexture(gl.TEXTURE_3D, gl.createTexture());
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.R8, ...shape, 0, gl.RED, gl.UNSIGNED_BYTE, content);
    for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(gl.TEXTURE_3D, side, gl.CLAMP_TO_EDGE);
    for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, which, filter);
  }
  texture(0, data.shape, await bytes(data.kinds), gl.NEAREST);
  const volumes = [];
  for (const each of data.values) volumes.push(await bytes(each.content));
  const state = { turn: 0.6, tilt: 0.45, zoom: 0.52, low: [0, 0, 0], high: [...data.size], field: -1, shown: data.colours.map((c) => c[3]) };
  function draw() {
    const wide = Math.max(1, Math.round(canvas.clientWidth * Math.min(devicePixelRatio, 2)));
    canvas.width = wide; canvas.height = Math.round(wide * 0.75);
    gl.viewport(0, 0, canvas.width, canvas.height);
    const [c, s, d, u] = [Math.cos(state.turn), Math.sin(state.turn), Math.cos(state.tilt), Math.sin(state.tilt)];
    // Columns: to the right, up and to the eye; z is up.
    gl.uniformMatrix3fv(at("turn"), false, [c, s, 0, -u * s, u * c, d, d * s, -d * c, u]);
    gl.uniform3fv(at("size"), data.size); gl.uniform3fv(at("low"), state.low); gl.uniform3fv(at("high"), state.high);
    gl.uniform3fv(at("cells"), data.shape);
    const colours = new Float32Array(64);
    data.colours.forEach((each, k) => colours.set([...each.slice(0, 3), state.field < 0 ? state.shown[k] : 1], 4 * k));
    gl.uniform4fv(at("colours"), colours);
    gl.uniform1f(at("zoom"), state.zoom); gl.uniform1f(at("ratio"), canvas.width / canvas.height);
    gl.uniform1i(at("valued"), state.field >= 0 ? 1 : 0); gl.uniform1i(at("kinds"), 0); gl.uniform1i(at("values"), 1);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    // Names of the axes stand at the middles of the edges nearest to the viewer's lower left.
    const span = Math.hypot(...data.size) * state.zoom, ratio = canvas.width / canvas.height;
    const ends = [[0.5, 0, 0], [1, 0.5, 0], [0, 0, 0.5]];
    root.querySelectorAll("[data-axis]").forEach((name, axis) => {
      const [x, y, z] = ends[axis].map((part, k) => (part - 0.5) * data.size[k] * 1.12);
      const [right, up] = [c * x + s * y, -u * s * x + u * c * y + d * z];
      name.style.left = `${50 + 50 * right / (span * ratio)}%`; name.style.top = `${50 - 50 * up / span}%`;
    });
  }
  let before = null, waits = false;
  const soon = () => { if (!waits) { waits = true; setTimeout(() => { waits = false; draw(); }, 15); } };
  canvas.addEventListener("pointerdown", (event) => { before = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointerup", () => { before = null; });
  canvas.addEventListener("pointermove", (event) => {
    if (!before) return;
    state.turn -= 0.01 * (event.clientX - before[0]);
    state.tilt = Math.max(-1.5, Math.min(1.5, state.tilt + 0.01 * (event.clientY - before[1])));
    before = [event.clientX, event.clientY]; soon();
  });
  canvas.addEventListener("wheel", (event) => { event.preventDefault(); state.zoom *= Math.exp(0.001 * event.deltaY); soon(); }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (step) { event.preventDefault(); state.turn += step[0]; state.tilt += step[1]; soon(); }
  });
  root.querySelectorAll("[data-cut]").forEach((slider) => slider.addEventListener("input", () => {
    const axis = Number(slider.dataset.cut);
    // What is cut away is what looks at the eye first.
    if (axis === 1) state.low[axis] = (1 - slider.value) * data.size[axis]; else state.high[axis] = slider.value * data.size[axis];
    soon();
  }));
  root.querySelectorAll("[data-kind]").forEach((box) => box.addEventListener("input", () => { state.shown[Number(box.dataset.kind)] = box.checked ? 1 : 0; soon(); }));
  root.querySelectorAll("[name=field]").forEach((button) => button.addEventListener("input", () => {
    state.field = Number(button.value);
    if (state.field >= 0) { const each = data.values[state.field]; texture(1, each.shape, volumes[state.field], gl.LINEAR); }
    root.querySelectorAll("[data-scale]").forEach((scale) => { scale.hidden = Number(scale.dataset.scale) !== state.field; });
    soon();
  }));
  texture(1, [1, 1, 1], new Uint8Array(1), gl.NEAREST);
  addEventListener("resize", soon);
  root.classList.add("live");
  draw();
}
