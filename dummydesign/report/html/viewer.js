// Turnable view of triangle meshes: WebGL, parallel projection, flat shading, no library.
"use strict";
(() => {
  const holder = document.getElementById("view-data");
  if (!holder) return;
  const parts = JSON.parse(holder.textContent), canvas = document.getElementById("view-canvas");
  const gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) { document.getElementById("view-note").textContent = "This browser cannot draw in three dimensions; the STL files hold the parts."; canvas.remove(); return; }
  const shader = (kind, text) => { const s = gl.createShader(kind); gl.shaderSource(s, text); gl.compileShader(s); return s; };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `attribute vec3 place; attribute vec3 normal; uniform mat3 turn; uniform vec3 middle, lift; uniform vec2 scale;
    varying float light; void main() { vec3 p = turn * (place + lift - middle), n = turn * normal;
    light = 0.35 + 0.5 * max(dot(n, vec3(-0.35, 0.5, 0.79)), 0.0) + 0.25 * max(dot(n, vec3(0.8, 0.1, 0.6)), 0.0);
    gl_Position = vec4(p.x * scale.x, p.y * scale.y, -p.z * 0.001, 1.0); }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `precision mediump float; uniform vec3 colour; varying float light; void main() { gl_FragColor = vec4(colour * light, 1.0); }`));
  gl.linkProgram(program); gl.useProgram(program);
  const at = (name) => gl.getUniformLocation(program, name);
  const where = { place: gl.getAttribLocation(program, "place"), normal: gl.getAttribLocation(program, "normal") };
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const meshes = parts.map((part) => {
    const bytes = Uint8Array.from(atob(part.triangles), (c) => c.charCodeAt(0)), steps = new Uint16Array(bytes.buffer);
    const place = new Float32Array(steps.length), normal = new Float32Array(steps.length);
    for (let i = 0; i < steps.length; i++) place[i] = part.low[i % 3] + (part.high[i % 3] - part.low[i % 3]) * steps[i] / 65535;
    for (let t = 0; t < place.length; t += 9) {
      const u = [0, 1, 2].map((k) => place[t + 3 + k] - place[t + k]), v = [0, 1, 2].map((k) => place[t + 6 + k] - place[t + k]);
      const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], size = Math.hypot(...n) || 1;
      for (let c = 0; c < 3; c++) for (let k = 0; k < 3; k++) normal[t + 3 * c + k] = n[k] / size;
    }
    for (let k = 0; k < 3; k++) { low[k] = Math.min(low[k], part.low[k]); high[k] = Math.max(high[k], part.high[k]); }
    const buffer = (values) => { const b = gl.createBuffer(); gl.bindBuffer(gl.ARRAY_BUFFER, b); gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW); return b; };
    return { place: buffer(place), normal: buffer(normal), count: place.length / 3, colour: part.colour, lift: part.lift };
  });
  const view = { spin: -0.5, tilt: 1.0, zoom: 1 }, apart = document.getElementById("view-apart");
  const size = Math.hypot(...low.map((v, k) => high[k] - v));
  function paint() {
    const box = canvas.getBoundingClientRect(), dense = window.devicePixelRatio || 1;
    canvas.width = Math.max(1, Math.round(box.width * dense)); canvas.height = Math.max(1, Math.round(box.height * dense));
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0); gl.enable(gl.DEPTH_TEST); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const share = Number(apart.value), tallest = Math.max(...meshes.map((m) => m.lift)) * share;
    const a = Math.cos(view.spin), b = Math.sin(view.spin), c = Math.cos(view.tilt), d = Math.sin(view.tilt);
    gl.uniformMatrix3fv(at("turn"), false, [a, b * c, b * d, -b, a * c, a * d, 0, d, -c].map((v, i) => i % 3 === 2 ? -v : v));
    gl.uniform3f(at("middle"), ...low.map((v, k) => (v + high[k] + (k === 2 ? tallest : 0)) / 2));
    const reach = 2.7 * view.zoom / (size + 0.6 * tallest), wide = canvas.width / canvas.height;
    gl.uniform2f(at("scale"), wide > 1 ? reach / wide : reach, wide > 1 ? reach : reach * wide);
    for (const mesh of meshes) {
      gl.uniform3f(at("lift"), 0, 0, mesh.lift * share);
      gl.uniform3f(at("colour"), ...mesh.colour);
      for (const name of ["place", "normal"]) {
        gl.bindBuffer(gl.ARRAY_BUFFER, mesh[name]); gl.enableVertexAttribArray(where[name]);
        gl.vertexAttribPointer(where[name], 3, gl.FLOAT, false, 0, 0);
      }
      gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
    }
  }
  let held = null;
  canvas.addEventListener("pointerdown", (e) => { held = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
  canvas.addEventListener("pointerup", () => { held = null; });
  canvas.addEventListener("pointermove", (e) => {
    if (!held) return;
    view.spin += (e.clientX - held[0]) * 0.01; view.tilt = Math.min(Math.max(view.tilt + (e.clientY - held[1]) * 0.01, 0), Math.PI);
    held = [e.clientX, e.clientY]; paint();
  });
  canvas.addEventListener("wheel", (e) => { e.preventDefault(); view.zoom *= Math.exp(-e.deltaY * 0.001); paint(); }, { passive: false });
  canvas.addEventListener("keydown", (e) => {
    const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[e.key];
    if (!turn) return;
    e.preventDefault(); view.spin += turn[0]; view.tilt = Math.min(Math.max(view.tilt + turn[1], 0), Math.PI); paint();
  });
  apart.addEventListener("input", paint); window.addEventListener("resize", paint);
  paint();
})();
