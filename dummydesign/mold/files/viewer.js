// Turnable view of triangle meshes: WebGL, parallel projection, light from above, edges and names, no library.
"use strict";
(() => {
  const holder = document.getElementById("view-data");
  if (!holder) return;
  const parts = JSON.parse(holder.textContent), canvas = document.getElementById("view-canvas");
  const gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) { document.getElementById("view-note").textContent = "This browser cannot draw in three dimensions; the STL files hold the parts."; canvas.remove(); return; }
  const shader = (kind, text) => { const s = gl.createShader(kind); gl.shaderSource(s, text); gl.compileShader(s); return s; };
  const program = gl.createProgram();
  // The sky lights from above whatever way the parts are turned; a lamp over the reader's shoulder shapes the sides.
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `attribute vec3 place; attribute vec3 normal; uniform mat3 turn; uniform vec3 middle, lift; uniform vec2 scale; uniform float near;
    varying float light; void main() { vec3 p = turn * (place + lift - middle), n = turn * normal;
    light = 0.42 + 0.26 * (0.5 + 0.5 * normal.z) + 0.36 * max(dot(n, vec3(-0.45, 0.55, 0.70)), 0.0) + 0.08 * max(dot(n, vec3(0.8, 0.0, 0.6)), 0.0);
    gl_Position = vec4(p.x * scale.x, p.y * scale.y, -p.z * 0.0005 - near, 1.0); }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `precision mediump float; uniform vec3 colour; uniform float plain; varying float light; void main() { gl_FragColor = vec4(colour * mix(light, 1.0, plain), 1.0); }`));
  gl.linkProgram(program); gl.useProgram(program);
  const at = (name) => gl.getUniformLocation(program, name);
  const where = { place: gl.getAttribLocation(program, "place"), normal: gl.getAttribLocation(program, "normal") };
  const buffer = (values) => { const b = gl.createBuffer(); gl.bindBuffer(gl.ARRAY_BUFFER, b); gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW); return b; };
  // Edges at which the surface turns by more than 14 degrees: neighbours on one curved face turn by less.
  const sharp = (steps, place, normal) => {
    const ids = new Map(), open = new Map(), lines = [];
    const id = (i) => { const k = (steps[i] * 65536 + steps[i + 1]) * 65536 + steps[i + 2]; let n = ids.get(k); if (n === undefined) ids.set(k, n = ids.size); return n; };
    for (let t = 0; t < place.length; t += 9) {
      const corner = [id(t), id(t + 3), id(t + 6)];
      for (let c = 0; c < 3; c++) {
        const a = corner[c], b = corner[(c + 1) % 3], k = Math.min(a, b) * 4194304 + Math.max(a, b), other = open.get(k);
        if (other === undefined) { open.set(k, t); continue; }
        if (normal[t] * normal[other] + normal[t + 1] * normal[other + 1] + normal[t + 2] * normal[other + 2] < 0.970)
          for (const i of [t + 3 * c, t + 3 * ((c + 1) % 3)]) lines.push(place[i], place[i + 1], place[i + 2]);
      }
    }
    return new Float32Array(lines);
  };
  const meshes = parts.map((part) => {
    const bytes = Uint8Array.from(atob(part.triangles), (c) => c.charCodeAt(0)), steps = new Uint16Array(bytes.buffer);
    const place = new Float32Array(steps.length), normal = new Float32Array(steps.length);
    for (let i = 0; i < steps.length; i++) place[i] = part.low[i % 3] + (part.high[i % 3] - part.low[i % 3]) * steps[i] / 65535;
    for (let t = 0; t < place.length; t += 9) {
      const u = [0, 1, 2].map((k) => place[t + 3 + k] - place[t + k]), v = [0, 1, 2].map((k) => place[t + 6 + k] - place[t + k]);
      const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], size = Math.hypot(...n) || 1;
      for (let c = 0; c < 3; c++) for (let k = 0; k < 3; k++) normal[t + 3 * c + k] = n[k] / size;
    }
    const edges = sharp(steps, place, normal), every = 9 * Math.max(1, Math.floor(place.length / 9 / 1500)), few = [];
    for (let i = 0; i < place.length; i += every) few.push([place[i], place[i + 1], place[i + 2]]);
    return { few, ...part, place: buffer(place), normal: buffer(normal), count: place.length / 3, edges: buffer(edges), edgeCount: edges.length / 3, shown: true };
  });
  const view = { spin: 0.42, tilt: 0.62, zoom: 1 }, apart = document.getElementById("view-apart");
  const labels = document.getElementById("view-labels"), lines = document.getElementById("view-lines"), list = document.getElementById("view-parts");
  if (list && meshes.length > 1) for (const mesh of meshes) {
    const label = document.createElement("label"), box = document.createElement("input"), swatch = document.createElement("i");
    box.type = "checkbox"; box.checked = true; swatch.className = "swatch";
    swatch.style.background = `rgb(${mesh.colour.map((c) => Math.round(255 * c)).join(",")})`;
    box.addEventListener("change", () => { mesh.shown = box.checked; paint(); });
    label.append(box, swatch, mesh.name); list.append(label);
  }
  const boxOf = (chosen, move) => {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const m of chosen) for (let k = 0; k < 3; k++) {
      low[k] = Math.min(low[k], m.low[k] + move(m)[k]); high[k] = Math.max(high[k], m.high[k] + move(m)[k]);
    }
    return [low, high];
  };
  const groups = [...new Set(meshes.map((m) => m.beside || 0))].sort((p, q) => p - q).map((x) => meshes.filter((m) => (m.beside || 0) === x));
  // What is shown turned over does not fit back into the others, so it stays apart.
  const risen = (m, share) => m.lift * (m.turned ? 1 : share);
  // Stacks stand side by side; on a screen held upright one under the other.
  function arrange(share, upright) {
    let below = null;
    for (const group of groups) {
      const [low, high] = boxOf(group, (m) => [0, 0, risen(m, share)]), middle = (low[0] + high[0]) / 2;
      const down = upright && below !== null ? below - high[2] - 0.55 * (high[1] - low[1]) : 0;
      for (const m of group) m.move = upright ? [-middle, 0, risen(m, share) + down] : [m.beside || 0, 0, risen(m, share)];
      below = low[2] + down;
    }
  }
  function paint() {
    const box = canvas.getBoundingClientRect(), dense = window.devicePixelRatio || 1, share = Number(apart.value);
    canvas.width = Math.max(1, Math.round(box.width * dense)); canvas.height = Math.max(1, Math.round(box.height * dense));
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0); gl.enable(gl.DEPTH_TEST); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const [a, b, c, d] = [Math.cos(view.spin), Math.sin(view.spin), Math.cos(view.tilt), Math.sin(view.tilt)];
    const right = [a, b, 0], up = [-b * d, a * d, c], near = [b * c, -a * c, d], upright = box.height > 1.15 * box.width;
    arrange(share, upright);
    const [low, high] = boxOf(meshes, (m) => m.move), middle = low.map((v, k) => (v + high[k]) / 2);
    // Names stand in strips at the sides, neighbouring parts on the right; the drawing fits the rest.
    const each = meshes.length > 1 ? Math.min(0.2, 120 / box.width) : 0, sides = groups.length > 1 && !upright ? 2 : 1, strip = each * sides;
    let wide = 1e-6, tall = 1e-6;
    for (const m of meshes) for (let i = 0; i < 8; i++) {
      const p = [0, 1, 2].map((k) => ((i >> k) & 1 ? m.high[k] : m.low[k]) + m.move[k] - middle[k]);
      wide = Math.max(wide, Math.abs(p[0] * right[0] + p[1] * right[1])); tall = Math.max(tall, Math.abs(p[0] * up[0] + p[1] * up[1] + p[2] * up[2]));
    }
    const perPixel = Math.max(wide / (0.48 * box.width * (1 - strip)), tall / (0.47 * box.height)) / view.zoom;
    const scale = [2 / (perPixel * box.width), 2 / (perPixel * box.height)];
    gl.uniformMatrix3fv(at("turn"), false, [right[0], up[0], near[0], right[1], up[1], near[1], right[2], up[2], near[2]]);
    // With names on the left alone, the rest is centred in the free space.
    const shift = sides === 1 ? strip * box.width / 2 * perPixel : 0, centre = middle.map((v, k) => v - right[k] * shift);
    gl.uniform3f(at("middle"), ...centre); gl.uniform2f(at("scale"), ...scale);
    const draw = (mesh, kind, count, plain, colour, lifted) => {
      gl.uniform1f(at("plain"), plain); gl.uniform1f(at("near"), lifted); gl.uniform3f(at("colour"), ...colour); gl.drawArrays(kind, 0, count);
    };
    const marks = [];
    for (const mesh of meshes) if (mesh.shown) {
      gl.uniform3f(at("lift"), ...mesh.move);
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.place); gl.enableVertexAttribArray(where.place); gl.vertexAttribPointer(where.place, 3, gl.FLOAT, false, 0, 0);
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.normal); gl.enableVertexAttribArray(where.normal); gl.vertexAttribPointer(where.normal, 3, gl.FLOAT, false, 0, 0);
      draw(mesh, gl.TRIANGLES, mesh.count, 0, mesh.colour, 0);
      gl.disableVertexAttribArray(where.normal); gl.vertexAttrib3f(where.normal, 0, 0, 1);
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.edges); gl.vertexAttribPointer(where.place, 3, gl.FLOAT, false, 0, 0);
      draw(mesh, gl.LINES, mesh.edgeCount, 1, mesh.colour.map((v) => 0.32 * v), 0.0004);
      // A name points at the outermost corner of its part.
      const far = sides === 2 && Boolean(mesh.beside);
      let best = null;
      for (const q of mesh.few) {
        const p = q.map((v, k) => v + mesh.move[k] - centre[k]);
        const x = (p[0] * right[0] + p[1] * right[1]) * scale[0], y = (p[0] * up[0] + p[1] * up[1] + p[2] * up[2]) * scale[1];
        if (!best || (far ? x > best[0] : x < best[0])) best = [x, y];
      }
      marks.push({ name: mesh.name, far, x: (best[0] + 1) / 2 * box.width, y: (1 - best[1]) / 2 * box.height });
    }
    if (!labels || meshes.length < 2) return;
    labels.textContent = ""; lines.textContent = "";
    for (const far of [false, true]) name(marks.filter((m) => m.far === far), box, far);
  }
  function name(marks, box, far) {
    const gap = Math.min(22, (box.height - 20) / Math.max(1, marks.length));
    marks.sort((p, q) => p.y - q.y);
    let last = -Infinity;
    for (const m of marks) { m.at = Math.max(Math.min(Math.max(m.y, 12), box.height - 12), last + gap); last = m.at; }
    for (let i = marks.length - 1, low = box.height - 10; i >= 0; i--) { marks[i].at = Math.min(marks[i].at, low); low = marks[i].at - gap; }
    for (const m of marks) {
      const label = document.createElement("span"); label.textContent = m.name; label.style.top = `${m.at}px`; label.className = far ? "far" : ""; labels.append(label);
      const end = far ? label.offsetLeft - 3 : label.offsetLeft + label.offsetWidth + 3, line = document.createElementNS("http://www.w3.org/2000/svg", "path");
      line.setAttribute("d", `M${end} ${m.at}L${far ? Math.min(end, m.x) : Math.max(end, m.x)} ${Math.min(Math.max(m.y, 0), box.height)}`); lines.append(line);
    }
  }
  const held = new Map();
  const spread = () => { const [p, q] = [...held.values()]; return Math.hypot(p[0] - q[0], p[1] - q[1]); };
  const turn = (x, y) => { view.spin -= x; view.tilt = Math.min(Math.max(view.tilt + y, -Math.PI / 2), Math.PI / 2); paint(); };
  canvas.addEventListener("pointerdown", (e) => { held.set(e.pointerId, [e.clientX, e.clientY]); canvas.setPointerCapture(e.pointerId); });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (e) => { held.delete(e.pointerId); });
  canvas.addEventListener("pointermove", (e) => {
    const before = held.get(e.pointerId);
    if (!before) return;
    const wide = held.size === 2 ? spread() : 0;
    held.set(e.pointerId, [e.clientX, e.clientY]);
    if (held.size === 2) { view.zoom = Math.min(Math.max(view.zoom * spread() / Math.max(wide, 1), 0.3), 20); paint(); return; }
    turn((e.clientX - before[0]) * 0.01, (e.clientY - before[1]) * 0.01);
  });
  canvas.addEventListener("wheel", (e) => { e.preventDefault(); view.zoom = Math.min(Math.max(view.zoom * Math.exp(-e.deltaY * 0.001), 0.3), 20); paint(); }, { passive: false });
  canvas.addEventListener("keydown", (e) => {
    const way = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[e.key];
    if (!way) return;
    e.preventDefault(); turn(...way);
  });
  apart.addEventListener("input", paint); window.addEventListener("resize", paint);
  paint();
})();
