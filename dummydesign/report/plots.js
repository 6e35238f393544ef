// Values under the pointer, and zoom, of every plot of a page: svg.plot with the ends of its axes in data-x and data-y.
// Pages may replace a plot at any time, so events are taken at the document. Without this script plots are pictures.
"use strict";
(() => {
  if (window.plotsRead) return;
  window.plotsRead = true;
  const MOST = 20, ROWS = 8, PLOT = "svg.plot[data-x]";
  const states = new WeakMap(), kept = new Map();
  let shown = null, drag = null, box = null, spoken = null;

  // An axis: values and places of its ends. A share is 0 at the low end and 1 at the high end.
  const axis = (text) => {
    const [low, high, start, stop] = text.split(" ").map(Number);
    return { low, high, start, stop, log: text.endsWith(" log") };
  };
  const share = (a, place) => (place - a.start) / (a.stop - a.start);
  const value = (a, s) => a.log ? a.low * Math.pow(a.high / a.low, s) : a.low + s * (a.high - a.low);
  const shareOf = (a, v) => a.log ? Math.log(v / a.low) / Math.log(a.high / a.low) : (v - a.low) / (a.high - a.low);
  const words = (v) => String(Number(v.toPrecision(Math.abs(v) < 1e-12 ? 1 : 4)));
  const within = (s) => s > -0.999 && s < 1.999;  // places further out are cut off there

  function element(name, className, parent) {
    const made = document.createElement(name);
    made.className = className;
    parent.append(made);
    return made;
  }

  // A map: its picture's colours lead back to values between the ends in data-v, along the colours in data-c.
  function mapOf(e) {
    const found = { ends: e.dataset.v.split(" ").map(Number), stops: e.dataset.c.split(" ").map((c) =>
      [1, 3, 5].map((k) => parseInt(c.slice(k, k + 2), 16))), pixels: null }, picture = new Image();
    picture.src = e.getAttribute("href");
    picture.decode().then(() => {
      const sheet = document.createElement("canvas"), { width, height } = picture;
      Object.assign(sheet, { width, height });
      const pen = sheet.getContext("2d", { willReadFrequently: true });
      pen.drawImage(picture, 0, 0);
      found.pixels = pen.getImageData(0, 0, width, height);
    }).catch(() => {});
    return found;
  }
  function mapWords({ ends: [low, high], stops, pixels }, across, down) {
    if (!pixels || !(across >= 0 && across < 1 && down >= 0 && down < 1)) return null;
    const at = 4 * (Math.floor(down * pixels.height) * pixels.width + Math.floor(across * pixels.width));
    const colour = pixels.data.slice(at, at + 3);
    if (pixels.data[at + 3] < 128) return "none";
    let best = [Infinity, 0];
    stops.slice(1).forEach((stop, i) => {
      const way = stop.map((v, k) => v - stops[i][k]), dot = (p, q) => p.reduce((sum, v, k) => sum + v * q[k], 0);
      const off = (part) => Math.hypot(...way.map((v, k) => stops[i][k] + part * v - colour[k]));
      const part = Math.min(Math.max(dot([0, 1, 2].map((k) => colour[k] - stops[i][k]), way) / dot(way, way), 0), 1);
      if (off(part) < best[0]) best = [off(part), (i + part) / (stops.length - 1)];
    });
    const text = words(low + Math.round(200 * best[1]) / 200 * (high - low));
    return text + (best[1] > 0.999 ? " or more" : best[1] < 0.001 ? " or less" : "");
  }

  // Names and points of what is drawn, in shares of both axes.
  function layersOf(svg, x, y) {
    const at = (px, py) => [share(x, px), share(y, py)], number = (e, name) => Number(e.getAttribute(name));
    return [...svg.querySelectorAll("[data-n]")].map((e) => {
      const name = e.dataset.n;
      if (e.tagName === "rect" || e.tagName === "image") {
        const [left, top] = at(number(e, "x"), number(e, "y"));
        const [right, bottom] = at(number(e, "x") + number(e, "width"), number(e, "y") + number(e, "height"));
        return { name, box: [left, right, bottom, top], map: e.tagName === "image" ? mapOf(e) : null };
      }
      if (e.tagName === "g") {
        return { name, dots: [...e.querySelectorAll("circle")].map((c) => at(number(c, "cx"), number(c, "cy"))) };
      }
      const area = e.classList.contains("area"), runs = e.getAttribute("d").replace("Z", "").split("M").slice(1)
        .map((run) => run.split("L").map((pair) => at(...pair.split(" ").map(Number))));
      if (area) for (const run of runs) run.push(run[0]);
      return { name, area, runs, sideways: "s" in e.dataset };
    });
  }

  function stateOf(svg) {
    const known = states.get(svg);
    if (known && known.first === svg.firstElementChild) return known;
    svg.querySelector("title")?.remove();  // the browser would show it over the values
    const x = axis(svg.dataset.x), y = axis(svg.dataset.y), labels = [...svg.querySelectorAll("text.label")];
    const named = labels.slice(0, 2).map((e) => {
      const found = e.textContent.match(/^(.*?)\s*(?:\[(.*)\]|\(.*)?$/);
      return { name: found[1], unit: found[2] && found[2] !== "-" ? " " + found[2] : "" };
    });
    const s = {
      svg, x, y, source: svg.innerHTML, first: svg.firstElementChild, key: svg.querySelector("clipPath")?.id,
      xName: named[0] || { name: "", unit: "" }, yName: named[1] || { name: "", unit: "" },
      view: { x: [0, 1], y: [0, 1] }, at: null, layers: layersOf(svg, x, y), bars: !!svg.querySelector(".bar"),
    };
    states.set(svg, s);
    const before = kept.get(s.key);
    if (before) {
      for (const side of ["x", "y"]) {
        const ends = (before[side] || []).map((v) => Math.min(Math.max(shareOf(s[side], v), 0), 1));
        if (ends[1] - ends[0] >= 0.999 / MOST) s.view[side] = ends;
      }
      draw(s);
    }
    return s;
  }

  const full = (s) => ["x", "y"].every((side) => s.view[side][0] <= 0 && s.view[side][1] >= 1);
  const placed = (s, side, t) => {
    const [low, high] = s.view[side], a = s[side];
    return a.start + (t - low) / (high - low) * (a.stop - a.start);
  };

  function ticks(a, [first, last], about) {
    const low = value(a, first), high = value(a, last), found = [];
    if (a.log) {
      for (let p = Math.floor(Math.log10(low)); p <= Math.log10(high); p++)
        for (const f of high / low > 100 ? [1] : [1, 2, 5]) found.push(f * Math.pow(10, p));
      const inside = found.filter((v) => v >= low && v <= high);
      if (inside.length > 2) return inside;
      found.length = 0;
    }
    const power = Math.pow(10, Math.floor(Math.log10((high - low) / about)));
    const step = [1, 2, 2.5, 5, 10].map((f) => f * power).find((s) => s >= (high - low) / about * (1 - 1e-9));
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9); k++) found.push(k * step);
    return found;
  }

  function drawTicks(s) {
    const { x, y } = s, group = s.svg.querySelector("g.ticks"), text = (v) => String(Number(v.toPrecision(6)));
    if (!group) return;
    let made = "";
    for (const v of ticks(x, s.view.x, Math.max((x.stop - x.start) / 62, 2))) {
      const at = placed(s, "x", shareOf(x, v)).toFixed(1);
      made += `<line class="grid" x1="${at}" x2="${at}" y1="${y.start}" y2="${y.stop}"/>`
        + `<text x="${at}" y="${y.start + 16}" text-anchor="middle">${text(v)}</text>`;
    }
    for (const v of s.bars ? [] : ticks(y, s.view.y, Math.max((y.start - y.stop) / 50, 2))) {
      const at = placed(s, "y", shareOf(y, v));
      made += `<line class="grid" x1="${x.start}" x2="${x.stop}" y1="${at.toFixed(1)}" y2="${at.toFixed(1)}"/>`
        + `<text x="${x.start - 6}" y="${(at + 4).toFixed(1)}" text-anchor="end">${text(v)}</text>`;
    }
    group.innerHTML = made;
  }

  // Everything inside the clipped group is moved; letters, points and widths of lines keep their size.
  function draw(s) {
    const { svg, view } = s;
    svg.innerHTML = s.source;
    s.first = svg.firstElementChild;
    if (s.key) {
      const ends = (side) => view[side][0] > 0 || view[side][1] < 1 ? view[side].map((t) => value(s[side], t)) : null;
      if (full(s)) kept.delete(s.key); else kept.set(s.key, { x: ends("x"), y: ends("y") });
    }
    if (!full(s)) {
      const moved = (side) => (p) => Number(placed(s, side, share(s[side], p)).toFixed(2));
      const mx = moved("x"), my = moved("y"), kx = 1 / (view.x[1] - view.x[0]), ky = 1 / (view.y[1] - view.y[0]);
      for (const e of svg.querySelectorAll("g[clip-path] *")) {
        const set = (name, change) => {
          if (e.hasAttribute(name)) e.setAttribute(name, change(Number(e.getAttribute(name))));
        };
        for (const name of ["x", "x1", "x2", "cx"]) set(name, mx);
        for (const name of ["y", "y1", "y2", "cy"]) set(name, my);
        for (const name of ["width", "rx"]) set(name, (v) => v * kx);
        for (const name of ["height", "ry"]) set(name, (v) => v * ky);
        if (e.hasAttribute("d")) {
          e.setAttribute("d", e.getAttribute("d").replace(/(-?[\d.]+) (-?[\d.]+)/g, (_, a, b) => mx(+a) + " " + my(+b)));
        }
      }
      drawTicks(s);
    }
    const reset = svg.closest("figure")?.querySelector("[data-zoom='0']");
    if (reset) reset.disabled = full(s);
    if (shown === s) show(s, false);
  }

  function zoom(s, factor, cx, cy) {
    for (const [side, centre] of [["x", cx], ["y", cy]]) {
      if (side === "y" && s.bars) continue;
      const [low, high] = s.view[side], wide = Math.min(Math.max((high - low) / factor, 1 / MOST), 1);
      const start = Math.min(Math.max(centre - (centre - low) * wide / (high - low), 0), 1 - wide);
      s.view[side] = [start, start + wide];
    }
    draw(s);
  }
  function reset(s) { s.view = { x: [0, 1], y: [0, 1] }; draw(s); }

  // Shares of y at which a polyline meets a share of x. Parts whose ends are cut off give none.
  function crossings(runs, t, level) {
    const found = [];
    for (const run of runs) for (let i = 1; i < run.length; i++) {
      const [[a, p], [b, q]] = [run[i - 1], run[i]];
      if (t < Math.min(a, b) || t > Math.max(a, b) || ![a, b, p, q].every(within) || (!level && p === q)) continue;
      found.push(...(a === b ? [p, q] : [p + (q - p) * (t - a) / (b - a)]));
    }
    return found.sort((a, b) => a - b).filter((v, i, all) => !i || v - all[i - 1] > 0.002);
  }

  // Every layer at the place of the crosshair: name, words, and the share of y nearest to it.
  function readings(s) {
    const [t, u] = s.at, y = (v) => words(value(s.y, v)), found = [];
    for (const layer of s.layers) {
      const add = (text, marks) => found.push({ name: layer.name, text, marks });
      if (layer.map) {
        const [left, right, low, high] = layer.box;
        const text = mapWords(layer.map, (t - left) / (right - left), (high - u) / (high - low));
        if (text) add(text, []);
      } else if (layer.box) {
        const [left, right, low, high] = layer.box;
        if (u >= low && u <= high) add(`${words(value(s.x, left))} to ${words(value(s.x, right))}${s.xName.unit}`, []);
      } else if (layer.dots) {
        const near = layer.dots.filter(([a]) => Math.abs(a - t) < 0.02 * (s.view.x[1] - s.view.x[0]))
          .sort((a, b) => Math.hypot(a[0] - t, a[1] - u) - Math.hypot(b[0] - t, b[1] - u))[0];
        if (near) add(`${y(near[1])}${s.yName.unit} at ${words(value(s.x, near[0]))}${s.xName.unit}`, [near[1]]);
      } else {
        const meets = crossings(layer.runs, t, true);
        if (!meets.length || s.bars) continue;
        const ends = [meets[0], meets[meets.length - 1]];
        // a band over the forces ends level at its last force: there it is known to one side only
        const known = layer.sideways ? crossings(layer.runs, t, false) : ends;
        const [open, shut] = ends.map((end) => !known.some((v) => Math.abs(v - end) < 0.005));
        if (open !== shut) add(`${open ? "below" : "above"} ${y(ends[open ? 1 : 0])}${s.yName.unit}`, [ends[open ? 1 : 0]]);
        else if (layer.area) add(`${y(ends[0])} to ${y(ends[1])}${s.yName.unit}`, ends);
        else add(meets.slice(0, 4).map(y).join(" and ") + s.yName.unit, meets);
      }
    }
    return found;
  }

  function show(s, spoke) {
    const { svg, x, y } = s, [t, u] = s.at, px = placed(s, "x", t), py = placed(s, "y", u), read = readings(s);
    if (shown && shown !== s) hide();
    shown = s;
    svg.querySelector("g.cross")?.remove();
    const cross = svg.appendChild(document.createElementNS(svg.namespaceURI, "g"));
    cross.setAttribute("class", "cross");
    const inside = (p, a) => p >= Math.min(a.start, a.stop) - 0.01 && p <= Math.max(a.start, a.stop) + 0.01;
    let made = inside(px, x) ? `<path d="M${px} ${y.start}L${px} ${y.stop}"/>` : "";
    made += inside(py, y) ? `<path d="M${x.start} ${py}L${x.stop} ${py}"/>` : "";
    for (const mark of inside(px, x) ? read.flatMap((one) => one.marks) : []) {
      const at = placed(s, "y", mark);
      if (inside(at, y)) made += `<circle cx="${px}" cy="${at}" r="3.5"/>`;
    }
    if (drag?.to && drag.s === s) {
      const [a, b] = [drag.from, drag.to].map(([p, q]) => [placed(s, "x", p), placed(s, "y", q)]);
      made += `<rect x="${Math.min(a[0], b[0])}" y="${Math.min(a[1], b[1])}" width="${Math.abs(a[0] - b[0])}" `
        + `height="${Math.abs(a[1] - b[1])}"/>`;
    }
    cross.innerHTML = made;
    const here = `${s.xName.name} ${words(value(x, t))}${s.xName.unit}`;
    const over = s.bars ? [] : [`${s.yName.name} ${words(value(y, u))}${s.yName.unit}`];
    const far = (one) => Math.min(...one.marks.map((mark) => Math.abs(mark - u)), 9);
    const near = read.length > ROWS ? [...read].sort((a, b) => far(a) - far(b)).slice(0, ROWS) : read;
    const rows = read.filter((one) => near.includes(one)).map((one) => (one.name ? one.name + ": " : "") + one.text);
    if (read.length > ROWS) rows.push(`${read.length - ROWS} more`);
    box.replaceChildren();
    for (const text of [[here, ...over].join(", "), ...rows]) element("div", "", box).textContent = text;
    box.hidden = false;
    const frame = svg.getBoundingClientRect(), scale = frame.width / svg.viewBox.baseVal.width;
    const cx = frame.left + px * scale, cy = frame.top + py * scale, wide = box.offsetWidth, high = box.offsetHeight;
    const left = cx + 14 + wide < document.documentElement.clientWidth ? cx + 14 : cx - 14 - wide;
    box.style.left = Math.max(Math.min(left, document.documentElement.clientWidth - wide - 4), 4) + "px";
    box.style.top = Math.max(Math.min(cy - high - 10, innerHeight - high - 4), 4) + "px";
    if (spoke) spoken.textContent = [here, ...rows].join("; ");
  }

  function hide() {
    if (!shown) return;
    shown.svg.querySelector("g.cross")?.remove();
    shown.at = null;
    shown = null;
    box.hidden = true;
  }

  // Shares of the whole plot under a pointer; null outside the frame.
  function under(s, event, clamped) {
    const frame = s.svg.getBoundingClientRect(), scale = s.svg.viewBox.baseVal.width / frame.width;
    const found = ["x", "y"].map((side) => {
      const t = share(s[side], (side === "x" ? event.clientX - frame.left : event.clientY - frame.top) * scale);
      return clamped ? Math.min(Math.max(t, 0), 1) : t;
    });
    if (found.some((t) => t < 0 || t > 1)) return null;
    return found.map((t, k) => { const [low, high] = s.view[k ? "y" : "x"]; return low + t * (high - low); });
  }
  const plotOf = (event) => event.target instanceof Element ? event.target.closest(PLOT) : null;

  function follow(event) {
    const svg = drag ? drag.s.svg : plotOf(event);
    if (!svg || !svg.isConnected) { drag = null; if (event.pointerType === "mouse") hide(); return; }
    const s = stateOf(svg), at = under(s, event, !!drag);
    if (!at) { hide(); return; }
    s.at = at;
    if (drag) drag.to = at;
    show(s, false);
  }

  function release(event) {
    if (!drag) return;
    const { s, from, to } = drag;
    drag = null;
    if (!to || event.type === "pointercancel") return;
    let drawn = false;
    for (const [k, side] of [[0, "x"], [1, "y"]]) {
      const ends = [from[k], to[k]].sort((a, b) => a - b), [low, high] = s.view[side];
      if ((ends[1] - ends[0]) * Math.abs(s[side].stop - s[side].start) / (high - low) < 8 || (k && s.bars)) continue;
      const wide = Math.max(ends[1] - ends[0], 1 / MOST), start = Math.min(ends[0], 1 - wide);
      s.view[side] = [start, start + wide];
      drawn = true;
    }
    if (drawn) draw(s);
    follow(event);
  }

  const middle = (s, side) => 0.5 * (s.view[side][0] + s.view[side][1]);
  function press(s, sign) {
    if (sign === "0") reset(s);
    else {
      const seen = s.at && ["x", "y"].every((side, k) => s.at[k] >= s.view[side][0] && s.at[k] <= s.view[side][1]);
      const [cx, cy] = seen ? s.at : [middle(s, "x"), middle(s, "y")];
      zoom(s, sign === "+" ? 1.6 : 1 / 1.6, cx, cy);
    }
  }

  function key(event) {
    const svg = plotOf(event);
    if (!svg || event.ctrlKey || event.metaKey || event.altKey) return;
    const s = stateOf(svg), sign = event.key === "=" ? "+" : event.key;
    if (["+", "-", "0"].includes(sign)) press(s, sign);
    else if (sign === "Escape") hide();
    else {
      const way = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [1, 1], ArrowDown: [1, -1], Home: [0, -200], End: [0, 200] }[sign];
      if (!way) return;
      const [k, steps] = way, side = k ? "y" : "x", [low, high] = s.view[side];
      if (s.at) {
        const wide = high - low, t = s.at[k] + steps * (event.shiftKey ? 0.1 : 0.01) * wide;
        const most = Math.abs(steps) > 1 ? [low, high] : [0, 1];
        s.at[k] = Math.min(Math.max(t, most[0]), most[1]);
        const off = Math.min(s.at[k] - low, 0) + Math.max(s.at[k] - high, 0);
        if (off) { s.view[side] = [low + off, high + off]; draw(s); }
      } else s.at = [middle(s, "x"), middle(s, "y")];
      show(s, true);
    }
    event.preventDefault();
  }

  function wheel(event) {
    const svg = plotOf(event);
    if (!svg || !(event.ctrlKey || document.activeElement === svg)) return;
    const s = stateOf(svg), at = under(s, event, false);
    if (!at || (!event.ctrlKey && full(s) && event.deltaY > 0)) return;
    event.preventDefault();
    zoom(s, Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.002)), ...at);
  }

  // Plots of the page, and those that come later, get a place in the order of keys and three buttons.
  function equip(svg) {
    if (!svg.hasAttribute("tabindex")) {
      svg.setAttribute("tabindex", "0");
      svg.setAttribute("role", "application");
      svg.setAttribute("aria-roledescription", "plot");
      svg.setAttribute("aria-describedby", "plot-keys");
      const tools = svg.closest("figure") && element("div", "zoom noprint", svg.closest("figure"));
      for (const [sign, text] of tools ? [["+", "Zoom in"], ["-", "Zoom out"], ["0", "Reset the zoom"]] : []) {
        const button = element("button", "", tools);
        button.type = "button";
        button.tabIndex = -1;  // the plot has the keys + - 0: one stop of Tab for each plot, not four
        button.dataset.zoom = sign;
        button.textContent = { "+": "+", "-": "\u2212", "0": "\u21ba" }[sign];
        button.setAttribute("aria-label", text);
        button.disabled = sign === "0";
      }
      if (tools) svg.after(tools);
    }
    stateOf(svg);
  }
  function start() {
    if (box?.isConnected || !document.body) return;
    box = element("div", "reading", document.body);
    box.setAttribute("aria-hidden", "true");
    box.hidden = true;
    const content = document.querySelector("main") || document.body;
    spoken = element("div", "spoken", content);
    spoken.setAttribute("aria-live", "polite");
    const keys = element("div", "spoken", content);
    keys.id = "plot-keys";
    keys.textContent = "Arrow keys read values. Plus, minus and 0 zoom.";
  }
  function equipAll(root) {
    const found = [...(root.matches?.(PLOT) ? [root] : []), ...(root.querySelectorAll?.(PLOT) || [])];
    if (found.length) start();
    found.forEach(equip);
  }
  new MutationObserver((records) => {
    for (const { target, addedNodes } of records) {
      const own = target instanceof Element && target.closest(PLOT);
      if (own && own !== target) continue;
      if (own) equipAll(own); else addedNodes.forEach(equipAll);
    }
    if (shown && !shown.svg.isConnected) { shown = null; box.hidden = true; }
  }).observe(document, { childList: true, subtree: true });
  equipAll(document);

  document.addEventListener("pointermove", follow);
  document.addEventListener("pointerdown", (event) => {
    if (event.target instanceof Element && event.target.closest("[data-zoom]")) return;
    const svg = plotOf(event), s = svg && stateOf(svg), at = s && under(s, event, false);
    if (!at) { hide(); return; }
    s.at = at;
    if (event.pointerType === "mouse" && event.button === 0) {
      drag = { s, from: at, to: null };
      event.preventDefault();  // no text is marked
      svg.focus({ preventScroll: true });
    }
    show(s, false);
  });
  for (const name of ["pointerup", "pointercancel"]) document.addEventListener(name, release);
  document.addEventListener("dblclick", (event) => { const svg = plotOf(event); if (svg) { reset(stateOf(svg)); follow(event); } });
  document.addEventListener("click", (event) => {
    const button = event.target instanceof Element && event.target.closest("[data-zoom]");
    const svg = button && button.closest("figure")?.querySelector(PLOT);
    if (svg) press(stateOf(svg), button.dataset.zoom);
  });
  document.addEventListener("keydown", key);
  document.addEventListener("focusout", (event) => { if (plotOf(event)) hide(); });
  document.addEventListener("wheel", wheel, { passive: false });
  document.addEventListener("scroll", hide, { passive: true, capture: true });
  document.documentElement.addEventListener("pointerleave", () => { if (!drag) hide(); });
})();
