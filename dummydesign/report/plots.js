// Draws every div.plot of a page by plotly.js from its data-plot: values under the pointer or by the arrow keys, zoom.
// Pages may replace a plot at any time: one of the same name is drawn anew in its place and keeps its zoom.
"use strict";
(() => {
  if (window.plotsRead) return;
  window.plotsRead = true;
  const PLOT = "div.plot[data-plot]", drawn = new Map(), waiting = new Set(), sight = new Set(), late = new Set();
  const dark = matchMedia("(prefers-color-scheme:dark)"), NARROW_PX = 240, REST_MS = 150;
  let spoken = null, loading = null, busy = false, resting = 0, colours = {};

  // plotly.js lies packed in the page, or at an address
  async function load() {
    const { dataset, textContent } = document.getElementById("plotly");
    const packed = dataset.src ? (await fetch(dataset.src)).body
      : new Blob([Uint8Array.from(atob(textContent), (c) => c.charCodeAt(0))]).stream();
    const script = document.createElement("script");
    script.textContent = await new Response(packed.pipeThrough(new DecompressionStream("gzip"))).text();
    document.head.append(script);
    spoken = document.createElement("div");
    spoken.className = "spoken";
    spoken.setAttribute("aria-live", "polite");
    (document.querySelector("main") || document.body).append(spoken);
  }

  const of = (name) => colours[name] ??= getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  function draw(div) {
    div.spec ??= JSON.parse(div.dataset.plot);
    const { data, layout } = JSON.parse(JSON.stringify(div.spec).replace(/var\((--\w+)\)/g, (_, name) => of(name)));
    const narrow = div.clientWidth < NARROW_PX;
    if (narrow) {
      for (const one of [layout.xaxis, layout.yaxis]) delete one.title;
      if (layout.xaxis.dtick) Object.assign(layout.xaxis, { dtick: div.clientWidth < 0.7 * NARROW_PX ? 2 : 1, tickangle: 0 });
    }
    const axis = { color: of("--soft"), gridcolor: of("--rule"), linecolor: of("--other"), showline: true, mirror: true,
      zeroline: false, zerolinecolor: of("--other"), automargin: true, hoverformat: ".4~g", title: { font: { color: of("--ink") }, standoff: 6 } };
    layout.template = { layout: { xaxis: axis, yaxis: axis, autosize: true, showlegend: false,
      margin: narrow ? { l: 24, r: 6, t: 6, b: 20 } : { l: 58, r: 14, t: 26, b: 48 },
      font: { size: narrow ? 10 : 12, family: getComputedStyle(div).fontFamily, color: of("--soft") },
      paper_bgcolor: of("--paper"), plot_bgcolor: of("--paper"), barmode: "overlay", hoverdistance: 12,
      dragmode: matchMedia("(pointer:coarse)").matches ? false : "zoom",
      modebar: { bgcolor: "transparent", color: of("--soft"), activecolor: of("--ink") },
      hoverlabel: { bgcolor: of("--panel"), bordercolor: of("--soft"), font: { color: of("--ink") }, namelength: -1 } },
      data: { scatter: [{ marker: { size: 8, line: { color: of("--paper"), width: 1.5 } } }] } };
    layout.uirevision = 1;  // a zoom stays when the values change
    const first = !div.classList.contains("js-plotly-plot");
    if (first) div.replaceChildren();
    Plotly.react(div, data, layout, { displaylogo: false, responsive: true, doubleClick: "reset",
      modeBarButtons: [["zoomIn2d", "zoomOut2d", "resetScale2d"]] });
    if (!first) return;
    window.plotDrawn?.(div);
    div.tabIndex = 0;
    div.setAttribute("role", "application");
    div.setAttribute("aria-roledescription", "plot: arrow keys read values; plus, minus and 0 zoom");
    for (const button of div.querySelectorAll(".modebar-btn")) button.tabIndex = -1;  // the plot has keys for them
  }

  // every other plot is a large one while there are any: what one looks at follows a slider first
  async function work() {
    await (loading ??= load());
    if (busy) return;
    busy = true;
    let large = false;
    try {
      while (waiting.size) {
        const all = [...waiting];
        large = !large && all.find((one) => !one.closest(".small"));
        const div = large || all.find((one) => sight.has(one)) || all[0];
        waiting.delete(div);
        if (div.isConnected) draw(div);
        await new Promise((done) => setTimeout(done));  // a page answers between two plots
      }
    } finally { busy = false; }
  }
  // to draw a plot takes plotly.js 20 ms: while a slider moves its curves alone are, along the axes that are there
  function move(div, data) {
    const { xaxis, yaxis } = div._fullLayout || {};
    for (const node of xaxis ? div.querySelectorAll(".scatterlayer .trace") : []) {
      const one = data[node.__data__[0].trace.index], path = node.querySelector(".js-line");
      if (!one || !path) continue;
      const points = one.x.map((x, k) => x === null || one.y[k] === null ? [] : [xaxis.d2p(x), yaxis.d2p(one.y[k])])
        .filter((point) => point.length && point.every(Number.isFinite)).map((point) => point.map((px) => px.toFixed(1)).join());
      path.setAttribute("d", points.length ? `M${points.join("L")}` : "M0,0");
    }
  }
  const watch = new IntersectionObserver((all) => all.forEach(({ target, isIntersecting }) =>
    sight[isIntersecting ? "add" : "delete"](target)));
  // what changed of plots that are drawn: traces by their number, and the layout
  window.changePlots = (changes) => {
    for (const { name, data, layout, title, alt } of changes) {
      const div = drawn.get(name);
      if (!div) continue;
      div.spec ??= JSON.parse(div.dataset.plot);
      Object.assign(div.spec.data, data);
      if (layout) div.spec.layout = layout;
      div.setAttribute("aria-label", alt);
      div.closest("figure").querySelector("strong").textContent = title;
      move(div, data);
      waiting.delete(div);
      late.add(div);
    }
    clearTimeout(resting);
    resting = setTimeout(() => { late.forEach((div) => waiting.add(div)); late.clear(); work(); }, REST_MS);
  };
  function add(root) {
    for (let div of root.matches?.(PLOT) ? [root] : root.querySelectorAll?.(PLOT) || []) {
      const { name, plot } = div.dataset, before = drawn.get(name);
      if (before === div) continue;
      if (before && !before.isConnected) {
        before.dataset.plot = plot;
        before.spec = null;
        before.setAttribute("aria-label", div.getAttribute("aria-label"));
        div.replaceWith(before);
        div = before;
      }
      drawn.set(name, div);
      waiting.add(div);
      watch.observe(div);
    }
    if (waiting.size) work();
  }
  new MutationObserver((all) => all.forEach((one) => one.addedNodes.forEach(add))).observe(document, { childList: true, subtree: true });
  add(document);
  dark.addEventListener("change", () => { colours = {}; drawn.forEach((div) => waiting.add(div)); work(); });

  document.addEventListener("keydown", (event) => {
    const div = event.target;
    if (!div.matches?.(".js-plotly-plot") || event.ctrlKey || event.metaKey || event.altKey) return;
    const zoom = ["+", "-", "0"].indexOf(event.key === "=" ? "+" : event.key);
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (zoom >= 0) div.querySelectorAll(".modebar-btn")[zoom].click();
    else if (way) {
      const wide = div._fullLayout.xaxis._length, high = div._fullLayout.yaxis._length, step = event.shiftKey ? 0.1 : 0.01;
      const [x, y] = div.at || [0.5, 0.5];
      div.at = [x + step * way[0], y + step * way[1]].map((share) => Math.min(Math.max(share, 0), 1));
      Plotly.Fx.hover(div, { xpx: div.at[0] * wide, ypx: div.at[1] * high });
      spoken.textContent = [...div.querySelectorAll(".hoverlayer text")].map((one) => one.textContent).join("; ");
    } else return;
    event.preventDefault();
  });
  // a sheet is narrower than the window
  addEventListener("beforeprint", () => {
    for (const svg of document.querySelectorAll("svg.main-svg")) {
      svg.setAttribute("viewBox", `0 0 ${svg.getAttribute("width")} ${svg.getAttribute("height")}`);
    }
  });
})();
