// The pad model and the tissue law of the package, on the embedded table: same formulas, same steps.
// Units mm, N, s, MPa. Pure functions; the page's controls are in sliders.js.
"use strict";
const DD = (() => {
  const interp = (x, xs, ys) => {
    if (!(x > xs[0])) return ys[0];
    const n = xs.length - 1;
    if (x >= xs[n]) return ys[n];
    let a = 0, b = n;
    while (b - a > 1) { const m = (a + b) >> 1; if (xs[m] <= x) a = m; else b = m; }
    return ys[a] + (ys[b] - ys[a]) * (x - xs[a]) / (xs[b] - xs[a]);
  };
  const cheb = (c, u) => {
    let b1 = 0, b2 = 0;
    for (let i = c.length - 1; i > 0; i--) { const t = 2 * u * b1 - b2 + c[i]; b2 = b1; b1 = t; }
    return u * b1 - b2 + c[0];
  };
  const expm1over = (x) => x < 1e-9 ? 1 - x / 2 : -Math.expm1(-x) / x;

  // Elastic force over modulus of one slab on an even depth grid, as design/curves.py samples it.
  const SAMPLES = 481;
  // A square punch multiplies by its factor: pad/square.py.
  function squareFactor(square, ratio) {
    const [low, high] = square.ratio_range.map(Math.log), v = 2 * (Math.log(ratio) - low) / (high - low) - 1;
    const row = square.coefficients.map((c) => cheb(c, v)), stretch = Math.sqrt(1 + 1 / (ratio * ratio));
    const reach = interp(Math.log(ratio), square.reach_ratio.map(Math.log), square.reach_depth);
    return (x) => Math.exp(cheb(row, 2 * Math.min(x * stretch, reach) / square.depth_range[1] - 1));
  }
  function curve(table, square, thickness, radius) {
    const ratio = radius / thickness, [low, high] = table.ratio_range;
    if (ratio < low * (1 - 1e-9) || ratio > high * (1 + 1e-9)) return null;
    const logs = table.limit_ratio.map(Math.log);
    const limit = thickness * Math.min(0.6, interp(Math.log(ratio), logs, table.limit_depth));
    const v = 2 * (Math.log(ratio) - Math.log(low)) / (Math.log(high) - Math.log(low)) - 1;
    const row = table.coefficients.map((c) => cheb(c, v));
    const factor = square ? squareFactor(square, ratio) : () => 1;
    const [start, stop] = table.depth_range, area = new Float64Array(SAMPLES);
    for (let i = 1; i < SAMPLES; i++) {
      const depth = limit * i / (SAMPLES - 1), x = depth / thickness;
      area[i] = factor(x) * radius * depth * Math.exp(cheb(row, 2 * (x - start) / (stop - start) - 1));
    }
    return { thickness, limit, step: limit / (SAMPLES - 1), area };
  }
  const lookup = (values, position) => {
    const p = Math.min(Math.max(position, 0), values.length - 1), left = Math.min(Math.floor(p), values.length - 2);
    return values[left] * (1 - (p - left)) + values[left + 1] * (p - left);
  };
  const areaAt = (c, depth) => lookup(c.area, depth / c.step);
  function depthAt(c, area) {
    if (!(area <= c.area[SAMPLES - 1])) return NaN;
    let a = 0, b = SAMPLES - 1;
    while (b - a > 1) { const m = (a + b) >> 1; if (c.area[m] <= area) a = m; else b = m; }
    return c.step * (a + (area - c.area[a]) / (c.area[b] - c.area[a]));
  }
  function slopeAt(c, depth) {
    const g = (i) => {
      const A = c.area, n = SAMPLES - 1;
      if (i === 0) return (-1.5 * A[0] + 2 * A[1] - 0.5 * A[2]) / c.step;
      if (i === n) return (1.5 * A[n] - 2 * A[n - 1] + 0.5 * A[n - 2]) / c.step;
      return (A[i + 1] - A[i - 1]) / (2 * c.step);
    };
    const p = Math.min(Math.max(depth / c.step, 0), SAMPLES - 1), left = Math.min(Math.floor(p), SAMPLES - 2);
    return g(left) * (1 - (p - left)) + g(left + 1) * (p - left);
  }

  // Ramp, brake, hold: protocol/motion.py.
  function motion(v, depth, hold, decel, ramp, brake, holds) {
    const touch = Math.min(v, Math.sqrt(2 * decel * depth));
    let braking = touch / decel, straight = Math.max(depth - 0.5 * touch * braking, 0) / touch;
    const floor = 1e-9 * (straight + braking);
    straight = Math.max(straight, floor); braking = Math.max(braking, floor);
    const t = [], x = [], distance = 0.5 * touch * braking, stopped = straight + braking;
    for (let i = 0; i <= ramp; i++) { t.push(straight * i / ramp); x.push((depth - distance) * i / ramp); }
    for (let i = 1; i <= brake; i++) {
      const left = 1 - i / brake;
      t.push(straight + braking * (1 - left)); x.push(depth - distance * left * left);
    }
    const first = Math.min(1e-4, hold / (10 * holds)), step = Math.log(hold / first) / (holds - 1);
    for (let i = 0; i < holds; i++) { t.push(stopped + (i < holds - 1 ? first * Math.exp(step * i) : hold)); x.push(depth); }
    return { t, x, stop: stopped };
  }
  const max = (values) => values.reduce((a, b) => Math.max(a, b), -Infinity);

  // Press of a pad with Prony arms relative to the long-term modulus: design/curves.py.
  function press(c, young, arms, v, depth, protocol) {
    const s = protocol.fine, m = motion(v, depth, protocol.hold_s, protocol.deceleration_mm_s2, s[0], s[1], s[2]);
    const elastic = m.x.map((x) => areaAt(c, x)), force = elastic.slice();
    for (const arm of arms) {
      let q = elastic[0];
      force[0] += arm.beta * q;
      for (let i = 1; i < force.length; i++) {
        const r = (m.t[i] - m.t[i - 1]) / arm.tau;
        q = q * Math.exp(-r) + (elastic[i] - elastic[i - 1]) * expm1over(r);
        force[i] += arm.beta * q;
      }
    }
    return { t: m.t, x: m.x, stop: m.stop, force: force.map((f) => young * f) };
  }
  function steadyDepth(c, young, arms, force, v, hold) {
    let depth = depthAt(c, force / young);
    const slowest = max(arms.map((a) => a.tau).concat(0)), strongest = max(arms.map((a) => a.beta).concat(0));
    if (!(slowest > 0) || Math.exp(-hold / slowest) * strongest <= 1e-7) return depth;
    for (let k = 0; k < 8; k++) {
      const tried = Number.isFinite(depth) ? depth : c.limit;
      let share = 1;
      for (const arm of arms) share += arm.beta * Math.exp(-hold / arm.tau) * expm1over(tried / v / arm.tau);
      depth = depthAt(c, force / share / young);
      if (!(Math.abs(depth / tried - 1) >= 1e-6)) break;
    }
    return depth;
  }

  // Tissue law, as tissue/model/laws say it in their data. An arm's response for a unit spring and rate r = gamma / c.
  const GX = [-0.8611363115940526, -0.33998104358485626, 0.33998104358485626, 0.8611363115940526];
  const GW = [0.34785484513745385, 0.6521451548625461, 0.6521451548625461, 0.34785484513745385];
  function armOde(m, rate) {
    const out = new Float64Array(m.t.length);
    let stretch = 0;
    for (let i = 1; i < out.length; i++) {
      const dt = m.t[i] - m.t[i - 1], before = Math.max(m.x[i - 1], 0), after = Math.max(m.x[i], 0);
      const rise = after - before, decay = rate * dt * (before * before + before * after + after * after) / 3;
      let mean = 0;
      if (rise !== 0) {
        const a = rate * dt * after * after, b = rate * dt * after * rise, c = rate * dt * rise * rise / 3;
        const panels = decay < 0.25 ? 1 : 2 + Math.ceil(Math.log2(Math.max(decay, 1)));
        let low = 0;
        for (let k = panels - 1; k >= 0; k--) {
          const high = Math.pow(0.5, k);
          for (let g = 0; g < 4; g++) {
            const w = low + (high - low) * 0.5 * (GX[g] + 1);
            mean += (high - low) * 0.5 * GW[g] * Math.exp(-w * (a - w * (b - w * c)));
          }
          low = high;
        }
      }
      stretch = stretch * Math.exp(-decay) + rise * mean;
      out[i] = after * after * stretch;
    }
    return out;
  }
  function armRamp(runningClock, m, rate) {
    const rise = m.ideal.stop, v = m.ideal.depth / rise, r = Math.max(rate, 1e-300);
    return Float64Array.from(m.t, (t) => {
      const rising = Math.min(t, rise), held = Math.max(t - rise, 0);
      const clock = runningClock ? Math.max(t, rise) : rise;
      return -Math.expm1(-r * v * v * rising ** 3) * v / r * Math.exp(-r * (v * clock) ** 2 * held);
    });
  }
  // Stop and depth of the ideal ramp as measurement/landmarks.py finds them on these samples.
  function idealRamp(m) {
    const depth = max(m.x), reach = Math.min(0.02, 0.01 * depth);
    const crossing = (level) => {
      const i = m.x.findIndex((x) => x >= level);
      return m.t[i - 1] + (level - m.x[i - 1]) / (m.x[i] - m.x[i - 1]) * (m.t[i] - m.t[i - 1]);
    };
    const late = crossing(depth - reach), early = crossing(depth - 4 * reach);
    return { depth, stop: Math.min(late + (late - early) / 3, m.t[m.t.length - 1]) };
  }
  function dampersAt(subject, v) {
    const s = subject.speeds, c = subject.c;
    if (v <= s[0]) return c[0];
    for (let i = 1; i < s.length; i++) if (v <= s[i]) {
      const share = Math.log(v / s[i - 1]) / Math.log(s[i] / s[i - 1]);
      return c[i - 1].map((b, k) => b * Math.pow(c[i][k] / b, share));
    }
    return c[c.length - 1];
  }
  // Measured curves without a law, between the presses that were made: tissue/model/measured_curves.py.
  const carriedOn = (x, xs, ys) => {
    const n = xs.length - 1, slope = (i, j) => (ys[j] - ys[i]) / (xs[j] - xs[i]);
    return interp(x, xs, ys) + Math.min(x - xs[0], 0) * slope(0, 1) + Math.max(x - xs[n], 0) * slope(n - 1, n);
  };
  function speedsFor(speeds, v, apart) {
    const away = speeds.map((s) => Math.abs(Math.log(s.v / v))), near = away.indexOf(Math.min(...away));
    if (away[near] < Math.log(apart)) return [[speeds[near], 1]];
    const at = speeds.findIndex((s) => s.v > v);
    if (at < 1) return [];
    const share = Math.log(v / speeds[at - 1].v) / Math.log(speeds[at].v / speeds[at - 1].v);
    return [[speeds[at - 1], 1 - share], [speeds[at], share]];
  }
  function overSteady(speed, logDepth) {
    const d = speed.ln_depth, rows = speed.over_steady, place = Math.min(Math.max(logDepth, d[0]), d[d.length - 1]);
    if (d.length === 1) return rows[0];
    const i = Math.min(Math.max(d.findIndex((x) => x >= place), 1), d.length - 1), share = (place - d[i - 1]) / (d[i] - d[i - 1]);
    return rows[i].map((b, k) => (1 - share) * rows[i - 1][k] + share * b);
  }
  function curvesPress(law, subject, force, v, protocol) {
    const found = speedsFor(subject.speeds, v, law.speed_apart);
    const low = max(found.map(([s]) => s.force_N[0])), high = -max(found.map(([s]) => -s.force_N[1]));
    if (!found.length || force < low / law.force_apart || force > high * law.force_apart) return null;
    const logDepth = carriedOn(Math.log(force), subject.ln_force, subject.ln_depth), depth = Math.exp(logDepth);
    const rows = found.map(([s, share]) => overSteady(s, logDepth).map((r) => share * r * force));
    const both = rows[0].map((_, k) => rows.reduce((sum, row) => sum + row[k], 0)), n = law.shares.length;
    const rise = both.slice(0, n), hold = both.slice(n), m = motion(v, depth, protocol.hold_s, protocol.deceleration_mm_s2, 60, 24, 60);
    const carried = m.t.map((t, i) => t <= m.stop ? interp(m.x[i] / depth, law.shares, rise) : interp(t - m.stop, law.hold_times_s, hold));
    return { t: m.t, stop: m.stop, depth, force: carried };
  }
  const restForce = (law, s, x) => !law.measured ? s.gamma1 * x ** 3 : x > 0 ? Math.exp(carriedOn(Math.log(x), s.ln_depth, s.ln_force)) : 0;
  const restDepth = (law, s, force) =>
    law.measured ? Math.exp(carriedOn(Math.log(force), s.ln_force, s.ln_depth)) : Math.cbrt(force / s.gamma1);
  function tissueForce(law, subject, m, v) {
    const c = dampersAt(subject, v);
    let elastic = m.x.map((x) => Math.max(x, 0) ** 3);
    if (law.ideal_ramp) {
      m.ideal = idealRamp(m);
      const speed = m.ideal.depth / m.ideal.stop;
      elastic = m.t.map((t) => (speed * Math.min(t, m.ideal.stop)) ** 3);
    }
    const total = elastic.map((e) => subject.gamma1 * e);
    subject.gamma.forEach((gamma, k) => {
      const arm = law.ideal_ramp ? armRamp(law.running_clock, m, gamma / c[k]) : armOde(m, gamma / c[k]);
      for (let i = 0; i < total.length; i++) total[i] += gamma * arm[i];
    });
    return total;
  }
  function tissuePress(law, subject, force, v, protocol) {
    if (law.measured) return curvesPress(law, subject, force, v, protocol);
    const hold = protocol.hold_s, decel = protocol.deceleration_mm_s2;
    let depth = Math.cbrt(force / subject.gamma1);
    for (let k = 0; k < 30; k++) {
      const reached = tissueForce(law, subject, motion(v, depth, hold, decel, 24, 12, 3), v).pop();
      depth *= Math.cbrt(force / reached);
      if (Math.abs(reached / force - 1) < 1e-7) break;
    }
    const m = motion(v, depth, hold, decel, 60, 24, 60);
    return { t: m.t, stop: m.stop, depth, force: tissueForce(law, subject, m, v) };
  }
  // Envelope of the subjects' F(t) and share of a press inside it: tissue/ranges.py.
  function forceRange(law, subjects, force, v, protocol) {
    const curves = subjects.map((s) => tissuePress(law, s, force, v, protocol));
    if (curves.includes(null)) return null;
    const end = Math.min(...curves.map((c) => c.stop)) + protocol.hold_s;
    const grid = [...new Set(curves.flatMap((c) => c.t))].sort((a, b) => a - b).filter((t) => t <= end * (1 + 1e-12));
    const rows = curves.map((c) => grid.map((t) => interp(t, c.t, c.force)));
    const low = grid.map((_, i) => Math.min(...rows.map((r) => r[i])));
    const high = grid.map((_, i) => Math.max(...rows.map((r) => r[i])));
    const peaks = rows.map(max);
    return { grid, low, high, peak_low: Math.min(...peaks), peak_high: Math.max(...peaks) };
  }
  function insideShare(range, p, force) {
    const near = 0.01 * force, end = Math.min(p.t[p.t.length - 1], range.grid[range.grid.length - 1]);
    const within = (t) => {
      const f = interp(t, p.t, p.force);
      return f >= interp(t, range.grid, range.low) - near && f <= interp(t, range.grid, range.high) + near;
    };
    let rise = 0, held = 0;
    for (let i = 1; i <= 60; i++) rise += within(p.stop * i / 60);
    for (let i = 0; i <= 60; i++) {
      const since = 0.005 * Math.exp(Math.log(1 / 0.005) * i / 60) * Math.max(end - p.stop, 0.01);
      held += within(Math.min(p.stop + since, end));
    }
    return 0.5 * (rise / 60 + held / 61);
  }

  // All numbers of one design. state: thickness_mm, ratio, radius_mm, square, velocity_mm_s, force_N, base.
  function compute(data, state) {
    const square = state.square ? data.squares[state.base] : null;
    const c = curve(data.tables[state.base], square, state.thickness_mm, state.radius_mm);
    const out = { young_kPa: 1e3 * Math.exp(interp(state.ratio, data.resin.ratio, data.resin.ln_young_MPa)) };
    const arms = data.resin.tau_s.map((tau, k) => ({ tau, beta: interp(state.ratio, data.resin.ratio, data.resin.beta[k]) }));
    const young = out.young_kPa / 1e3;
    if (data.tissue) {
      const { law, subjects } = data.tissue;
      const range = forceRange(law, subjects, state.force_N, state.velocity_mm_s, data.protocol);
      const depths = subjects.map((s) => restDepth(law, s, state.force_N));
      if (range) { out.range = range; out.tissue_peak_low_N = range.peak_low; out.tissue_peak_high_N = range.peak_high; }
      else out.tissue_limit = `not every subject was pressed to ${state.force_N} N at ${+state.velocity_mm_s.toPrecision(3)} mm/s; all were pressed ${law.known}`;
      out.tissue_depth_low_mm = Math.min(...depths); out.tissue_depth_high_mm = Math.max(...depths);
    }
    if (!c) { out.limit = "punch radius over thickness is outside the table"; return out; }
    out.curve = { depth: Array.from(c.area, (_, i) => i * c.step), force: Array.from(c.area, (a) => young * a) };
    const depth = depthAt(c, state.force_N / young);
    if (!Number.isFinite(depth)) {
      out.limit = `${state.force_N} N needs more than ${c.limit.toFixed(2)} mm (${(c.limit / c.thickness).toFixed(2)} of the thickness)`;
      return out;
    }
    const slope = slopeAt(c, depth) * young;
    Object.assign(out, { depth_mm: depth, depth_over_thickness: depth / c.thickness, stiffness_N_per_mm: slope,
      exponent: slope * depth / state.force_N });
    const held = steadyDepth(c, young, arms, state.force_N, state.velocity_mm_s, data.protocol.hold_s);
    if (!Number.isFinite(held)) { out.limit = "the force at the end of the hold is out of reach"; return out; }
    out.press = press(c, young, arms, state.velocity_mm_s, held, data.protocol);
    out.held_depth_mm = held;
    out.peak_force_N = max(out.press.force);
    out.peak_over_steady = out.peak_force_N / state.force_N;
    if (out.range) out.inside_fraction = insideShare(out.range, out.press, state.force_N);
    return out;
  }
  return { compute, curve, interp, restForce };
})();
