// Controls of the live what-if: reads the sliders, asks DD.compute, writes numbers and draws two figures.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("live-data").textContent);
  const $ = (id) => document.getElementById(id);
  const names = ["ratio", "thickness", "size", "velocity", "force"];
  // speed and force run on a logarithmic slider
  const logarithmic = { velocity: true };
  const value = (name) => { const v = Number($("in-" + name).value); return logarithmic[name] ? Math.pow(10, v) : v; };
  const wanted = new URLSearchParams(location.hash.slice(1));
  for (const name of names) if (wanted.has(name)) {
    const v = Number(wanted.get(name));
    if (Number.isFinite(v)) $("in-" + name).value = logarithmic[name] ? Math.log10(v) : v;
  }
  for (const name of ["shape", "base"]) if (wanted.has(name)) $("in-" + name).value = wanted.get(name);

  const W = 440, H = 310, L = 58, R = 14, T = 14, B = 48;
  function roundStep(step) {
    const p = Math.pow(10, Math.floor(Math.log10(step)));
    return [1, 2, 2.5, 5, 10].map((f) => f * p).find((s) => s >= step * (1 - 1e-9));
  }
  function draw(id, xLabel, yLabel, layers, xr, yr, log) {
    const px = (x) => L + (W - L - R) * (log ? Math.log(Math.max(x, xr[0]) / xr[0]) / Math.log(xr[1] / xr[0]) : (x - xr[0]) / (xr[1] - xr[0]));
    const py = (y) => H - B - (H - B - T) * (y - yr[0]) / (yr[1] - yr[0]);
    let s = `<clipPath id="c-${id}"><rect x="${L}" y="${T}" width="${W - L - R}" height="${H - B - T}"/></clipPath>`;
    const xt = [];
    if (log) for (let p = Math.ceil(Math.log10(xr[0])); p <= Math.log10(xr[1]); p++) xt.push(Math.pow(10, p));
    else { const d = roundStep((xr[1] - xr[0]) / 6); for (let k = Math.ceil(xr[0] / d); k * d <= xr[1]; k++) xt.push(k * d); }
    const d = roundStep((yr[1] - yr[0]) / 5), yt = [];
    for (let k = Math.ceil(yr[0] / d); k * d <= yr[1]; k++) yt.push(k * d);
    const text = (v) => String(Number(v.toPrecision(6)));
    const named = (l) => `data-n="${l.name}"`;
    $(id).dataset.x = `${xr[0]} ${xr[1]} ${L} ${W - R}${log ? " log" : ""}`;
    $(id).dataset.y = `${yr[0]} ${yr[1]} ${H - B} ${T}`;
    s += '<g class="ticks">';
    for (const v of xt) s += `<line class="grid" x1="${px(v)}" x2="${px(v)}" y1="${T}" y2="${H - B}"/><text x="${px(v)}" y="${H - B + 16}" text-anchor="middle">${text(v)}</text>`;
    for (const v of yt) s += `<line class="grid" y1="${py(v)}" y2="${py(v)}" x1="${L}" x2="${W - R}"/><text x="${L - 6}" y="${py(v) + 4}" text-anchor="end">${text(v)}</text>`;
    s += `</g><g clip-path="url(#c-${id})">`;
    const join = (xs, ys) => xs.map((x, i) => (i ? "L" : "M") + px(x).toFixed(1) + " " + py(ys[i]).toFixed(1)).join("");
    for (const l of layers) {
      if (l.low) s += `<path class="area band" ${named(l)} d="${join(l.x.concat(l.x.slice().reverse()), l.low.concat(l.high.slice().reverse()))}Z"/>`;
      else if (l.dot) s += `<g ${named(l)}><circle class="dot ${l.style}" r="4" cx="${px(l.dot[0])}" cy="${py(l.dot[1])}"/></g>`;
      else s += `<path class="line ${l.style}" ${named(l)} d="${join(l.x, l.y)}"/>`;
    }
    s += `</g><rect class="frame" x="${L}" y="${T}" width="${W - L - R}" height="${H - B - T}"/>`;
    s += `<text class="label" x="${(L + W - R) / 2}" y="${H - 10}" text-anchor="middle">${xLabel}</text>`;
    s += `<text class="label" transform="translate(15 ${(T + H - B) / 2}) rotate(-90)" text-anchor="middle">${yLabel}</text>`;
    $(id).innerHTML = s;
  }

  function show() {
    const size = value("size"), square = $("in-shape").value === "square";
    const state = { ratio: value("ratio"), thickness_mm: value("thickness"), velocity_mm_s: value("velocity"), force_N: value("force"),
      square, radius_mm: square ? size / Math.sqrt(Math.PI) : size / 2, base: $("in-base").value };
    const units = { ratio: "", thickness: " mm", size: " mm", velocity: " mm/s", force: " N" };
    for (const name of names) $("out-" + name).textContent = Number(value(name).toPrecision(4)) + units[name];
    const r = DD.compute(data, state);
    const fields = { young_kPa: ["kPa", 4], depth_mm: ["mm", 4], depth_over_thickness: ["", 3], stiffness_N_per_mm: ["N/mm", 4], exponent: ["", 4],
      peak_force_N: ["N", 4], peak_over_steady: ["", 4], inside_fraction: ["", 2] };
    for (const [name, [unit, digits]] of Object.entries(fields)) {
      const cell = $("v-" + name);
      if (!cell) continue;
      const known = Number.isFinite(r[name]);
      cell.textContent = known ? Number(r[name].toPrecision(digits)) + (unit && " " + unit) : "–";
      cell.dataset.value = known ? r[name] : "";
    }
    const low = $("v-tissue_depth");
    if (low && data.tissue) {
      low.textContent = `${r.tissue_depth_low_mm.toPrecision(3)} to ${r.tissue_depth_high_mm.toPrecision(3)} mm`;
      $("v-tissue_peak").textContent = r.range ? `${r.tissue_peak_low_N.toPrecision(3)} to ${r.tissue_peak_high_N.toPrecision(3)} N` : "–";
    }
    $("live-limit").textContent = [r.limit, r.tissue_limit].filter(Boolean).join("; ");
    const top = 1.5 * state.force_N, layers = [], deep = Math.max(r.curve ? r.curve.depth[r.curve.depth.length - 1] : 1, r.tissue_depth_high_mm || 0);
    if (data.tissue) {
      const { law, subjects } = data.tissue, x = Array.from({ length: 80 }, (_, i) => deep * i / 79);
      const ends = x.map((v) => subjects.map((s) => Math.min(DD.restForce(law, s, v), 2 * top)));
      layers.push({ name: "subjects", x, low: ends.map((f) => Math.min(...f)), high: ends.map((f) => Math.max(...f)) });
    }
    if (r.curve) layers.push({ name: "pad", x: r.curve.depth, y: r.curve.force.map((f) => Math.min(f, 2 * top)), style: "main" });
    if (Number.isFinite(r.depth_mm)) layers.push({ name: "this press", dot: [r.depth_mm, state.force_N], style: "main" });
    draw("live-depth", "depth [mm]", "relaxed force [N]", layers, [0, deep], [0, top], false);
    const pressLayers = [];
    let highest = 1.2 * state.force_N, last = 10;
    if (r.range) { pressLayers.push({ name: "subjects", x: r.range.grid, low: r.range.low, high: r.range.high }); highest = Math.max(highest, 1.05 * r.range.peak_high); }
    if (r.press) {
      pressLayers.push({ name: "pad", x: r.press.t, y: r.press.force, style: "main" });
      highest = Math.max(highest, 1.05 * r.peak_force_N); last = r.press.t[r.press.t.length - 1];
    }
    draw("live-time", "time since contact [s]", "force [N]", pressLayers, [1e-3, last], [0, highest], true);
    const words = Number.isFinite(r.depth_mm) ? `At ${state.force_N} N the pad is ${r.depth_mm.toPrecision(3)} mm deep, local exponent ${r.exponent.toPrecision(3)}.` : r.limit;
    $("live-depth").setAttribute("aria-label", "Relaxed force over depth. " + words);
    $("live-time").setAttribute("aria-label", "Force over time on a logarithmic axis. " + (Number.isFinite(r.peak_force_N) ? `Peak ${r.peak_force_N.toPrecision(3)} N.` : r.limit));
  }
  for (const name of [...names, "shape", "base"]) $("in-" + name).addEventListener("input", show);
  show();
})();
