// Draws meshes, edges and thick lines with WebGL 2.

const LIT = [
  `#version 300 es
  layout(location=0) in vec3 at; layout(location=1) in vec3 normal;
  layout(location=2) in mat4x3 pose; layout(location=6) in vec4 tint; layout(location=7) in vec4 gleam;
  uniform mat4 clip; out vec3 n; out vec3 p; flat out vec4 color; flat out vec4 glow;
  void main() {
    p = pose * vec4(at, 1.0); n = mat3(pose) * normal; color = tint; glow = gleam; gl_Position = clip * vec4(p, 1.0);
  }`,
  `#version 300 es
  precision highp float; in vec3 n; in vec3 p; flat in vec4 color; flat in vec4 glow; out vec4 shade;
  uniform vec3 eye; uniform vec3 right; uniform vec3 up;
  void main() {
    vec3 v = normalize(eye - p); vec3 m = normalize(n); m = dot(m, v) < 0.0 ? -m : m;
    vec3 key = normalize(v * 0.75 + up * 0.65 - right * 0.45);
    float sky = 0.5 + 0.5 * m.z;
    float light = 0.30 + 0.20 * sky + 0.52 * max(dot(m, key), 0.0);
    float gloss = pow(max(dot(m, normalize(key + v)), 0.0), 40.0) * 0.14;
    float rim = pow(1.0 - max(dot(m, v), 0.0), 3.0) * 0.10;
    vec3 base = mix(color.rgb, glow.rgb, glow.a);
    shade = vec4(base * light + gloss + rim * sky, color.a);
  }`,
];
const FLAT = [
  `#version 300 es
  layout(location=0) in vec3 at; layout(location=2) in mat4x3 pose; layout(location=8) in vec4 tint;
  uniform mat4 clip; flat out vec4 color;
  void main() { gl_Position = clip * vec4(pose * vec4(at, 1.0), 1.0); gl_Position.z -= 0.00015 * gl_Position.w; color = tint; }`,
  `#version 300 es
  precision highp float; flat in vec4 color; out vec4 shade; void main() { shade = color; }`,
];
// Of each copy of a mesh: the columns of its pose, its colour, its glow, the colour of its edges; places and numbers.
const COPY = [[2, 3], [3, 3], [4, 3], [5, 3], [6, 4], [7, 4], [8, 4]];
const NONE = [0, 0, 0, 0];
const LENGTH = COPY.reduce((sum, [, size]) => sum + size, 0);
const THICK = [
  `#version 300 es
  layout(location=0) in vec3 a; layout(location=1) in vec3 b; layout(location=2) in vec4 tint;
  uniform mat4 clip; uniform vec2 screen; uniform float width; out vec4 ink;
  void main() {
    vec4 A = clip * vec4(a, 1.0); vec4 B = clip * vec4(b, 1.0);
    vec2 along = (B.xy / B.w - A.xy / A.w) * screen; float size = length(along);
    vec2 side = size > 0.0 ? vec2(-along.y, along.x) / size : vec2(0.0);
    vec4 end = (gl_VertexID & 1) == 0 ? A : B; float sign = (gl_VertexID & 2) == 0 ? 1.0 : -1.0;
    end.xy += side * sign * width / screen * end.w; end.z -= 0.0003 * end.w; gl_Position = end; ink = tint;
  }`,
  `#version 300 es
  precision highp float; in vec4 ink; uniform float fade; out vec4 shade;
  void main() { shade = vec4(ink.rgb, ink.a * fade); }`,
];

export class Renderer {
  // Throws if the browser has no WebGL 2.
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", { antialias: true, alpha: true, preserveDrawingBuffer: true });
    if (!this.gl) throw new Error("this browser has no WebGL 2");
    this.lit = this.program(LIT);
    this.flat = this.program(FLAT);
    this.thick = this.program(THICK);
    this.segments = this.gl.createBuffer();
    this.copies = this.gl.createBuffer();
  }

  program([vertex, fragment]) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    const uniforms = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
      const { name } = gl.getActiveUniform(program, i);
      uniforms[name] = gl.getUniformLocation(program, name);
    }
    return { program, uniforms };
  }

  // Put a mesh on the graphics card: { positions, normals, edges } of shapes.js.
  upload(mesh) {
    const { gl } = this;
    const solid = gl.createVertexArray();
    gl.bindVertexArray(solid);
    const buffers = [this.attribute(0, mesh.positions), this.attribute(1, mesh.normals)];
    const edges = gl.createVertexArray();
    gl.bindVertexArray(edges);
    buffers.push(this.attribute(0, mesh.edges));
    return { solid, corners: mesh.positions.length / 3, edges, ends: mesh.edges.length / 3, buffers };
  }

  release(uploaded) {
    uploaded.buffers.forEach((buffer) => this.gl.deleteBuffer(buffer));
    [uploaded.solid, uploaded.edges].forEach((array) => this.gl.deleteVertexArray(array));
  }

  attribute(place, data) {
    const { gl } = this;
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
    return buffer;
  }

  // items: { mesh, X, color, glow, edge, isSmall }; lines: { below, above } lists of [a, b, color].
  draw(camera, items, lines, edgeColor) {
    const { gl, canvas } = this;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    camera.aspect = width / Math.max(1, height);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const clip = camera.matrix();
    const { solid, clear } = this.grouped(items, edgeColor);
    this.drawLines(lines.below, clip, 1.1 * ratio, 1);
    this.drawSolids(solid, camera, clip);
    this.drawEdges(solid, clip);
    gl.depthMask(false);
    this.drawSolids(clear, camera, clip);
    gl.depthMask(true);
    this.drawEdges(clear, clip);
    this.drawLines(lines.above, clip, 1.6 * ratio, 1);
    gl.disable(gl.DEPTH_TEST);
    this.drawLines(lines.above, clip, 1.6 * ratio, 0.4);
  }

  // Copies of a mesh are drawn at once. Groups { mesh, first, count, large } of opaque and of clear ones; `large` have edges.
  grouped(items, edgeColor) {
    const [solid, clear] = [new Map(), new Map()];
    for (const item of items) {
      const groups = item.color[3] < 1 ? clear : solid;
      const group = groups.get(item.mesh);
      if (group) group.push(item);
      else groups.set(item.mesh, [item]);
    }
    const data = new Float32Array(items.length * LENGTH);
    let first = 0;
    const placed = (groups) => [...groups].map(([mesh, equal]) => {
      const large = equal.filter((item) => !item.isSmall);
      const copies = [...large, ...equal.filter((item) => item.isSmall)];
      copies.forEach(({ X, color, glow, edge }, i) => data.set([
        X[0], X[3], X[6], X[1], X[4], X[7], X[2], X[5], X[8], X[9], X[10], X[11], ...color, ...(glow ?? NONE), ...(edge ?? edgeColor),
      ], (first + i) * LENGTH));
      first += copies.length;
      return { mesh, first: first - copies.length, count: copies.length, large: large.length };
    });
    const found = { solid: placed(solid), clear: placed(clear) };
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.copies);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, data, this.gl.DYNAMIC_DRAW);
    return found;
  }

  drawSolids(groups, camera, clip) {
    const { gl } = this;
    const { program, uniforms } = this.lit;
    const { right, up } = camera.axes();
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.clip, false, clip);
    gl.uniform3fv(uniforms.eye, camera.eye);
    gl.uniform3fv(uniforms.right, right);
    gl.uniform3fv(uniforms.up, up);
    for (const { mesh, first, count } of groups) this.drawCopies(gl.TRIANGLES, mesh.solid, mesh.corners, first, count);
  }

  drawEdges(groups, clip) {
    const { gl } = this;
    const { program, uniforms } = this.flat;
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.clip, false, clip);
    for (const { mesh, first, large } of groups) if (mesh.ends && large) this.drawCopies(gl.LINES, mesh.edges, mesh.ends, first, large);
  }

  drawCopies(kind, array, corners, first, count) {
    const { gl } = this;
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.copies);
    let at = first * LENGTH;
    for (const [place, size] of COPY) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * LENGTH, 4 * at);
      gl.vertexAttribDivisor(place, 1);
      at += size;
    }
    gl.drawArraysInstanced(kind, 0, corners, count);
  }

  drawLines(segments, clip, width, fade) {
    if (!segments.length) return;
    const { gl } = this;
    const { program, uniforms } = this.thick;
    const data = new Float32Array(segments.flatMap(([a, b, color]) => [...a, ...b, ...color]));
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.clip, false, clip);
    gl.uniform2f(uniforms.screen, this.canvas.width, this.canvas.height);
    gl.uniform1f(uniforms.width, width);
    gl.uniform1f(uniforms.fade, fade);
    this.lineArray ??= gl.createVertexArray();
    gl.bindVertexArray(this.lineArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.segments);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    for (const [place, size, offset] of [[0, 3, 0], [1, 3, 12], [2, 4, 24]]) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 40, offset);
      gl.vertexAttribDivisor(place, 1);
    }
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, segments.length);
  }
}
