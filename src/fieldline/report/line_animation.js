"use strict";
// Draws the lines of a run between its frames; data: see line_animation.py.
(() => {
  const figure = document.getElementById("motion-of-lines");
  const run = JSON.parse(document.getElementById("motion-data").textContent);
  const MAGNIFIED = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
  const LEVER = 17, HALF = 9; // pixels of a body
  const still = window.matchMedia("(prefers-reduced-motion: reduce)");
  const canvases = [...figure.querySelectorAll("canvas")];
  const control = name => figure.querySelector(`[data-do="${name}"]`);
  const readout = figure.querySelector(".readout"), magnifiedBy = figure.querySelector("output");
  let colours = {}, share = 0, playing = false, before = 0, held = 0;

  const unpack = ({ scale, data }) => {
    const bytes = Uint8Array.from(atob(data), c => c.charCodeAt(0)), view = new DataView(bytes.buffer);
    return Float32Array.from({ length: bytes.length / 2 }, (_, k) => scale * view.getInt16(2 * k, true));
  };
  for (const line of run.lines) for (const key of ["ends", "deflection", "tension", "angles"]) line[key] = unpack(line[key]);
  for (const body of run.bodies) if (body.turn) body.turn = unpack(body.turn);

  const last = run.seconds.length - 1, length = run.seconds[last];

  // The frame before a time and how far it is on to the next one.
  const place = () => {
    const t = share * length;
    let low = 0, high = last;
    while (high - low > 1) { const middle = (low + high) >> 1; if (run.seconds[middle] <= t) low = middle; else high = middle; }
    const part = Math.min(1, Math.max(0, (t - run.seconds[low]) / (run.seconds[low + 1] - run.seconds[low])));
    return { k: low, part, t };
  };
  const between = (array, width, { k, part }) =>
    Array.from({ length: width }, (_, j) => (1 - part) * array[k * width + j] + part * array[(k + 1) * width + j]);

  const readColours = () => {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["ink", "soft", "faint", "grey", "x", "y", "z", "panel"]) colours[name] = style.getPropertyValue(`--${name}`).trim();
  };

  // Blue, pink, amber: seen on white and on black.
  const STOPS = [[0, 114, 178], [204, 121, 167], [230, 159, 0]];
  const tint = value => {
    const at = 2 * Math.min(1, Math.max(0, value)), k = Math.min(1, Math.floor(at)), part = at - k;
    return `rgb(${STOPS[k].map((c, j) => Math.round((1 - part) * c + part * STOPS[k + 1][j])).join(",")})`;
  };

  const rotate = (q, v) => {
    const [x, y, z, w] = q, s = Math.hypot(x, y, z, w) || 1, [a, b, c, d] = [x / s, y / s, z / s, w / s];
    const t = [2 * (b * v[2] - c * v[1]), 2 * (c * v[0] - a * v[2]), 2 * (a * v[1] - b * v[0])];
    return [v[0] + d * t[0] + b * t[2] - c * t[1], v[1] + d * t[1] + c * t[0] - a * t[2], v[2] + d * t[2] + a * t[1] - b * t[0]];
  };

  // Everything of an instant in orbital axes, and the box that the view must hold.
  const moment = now => {
    const magnify = MAGNIFIED[+control("magnify").value];
    const lines = run.lines.map(line => {
      const ends = between(line.ends, 6, now), off = between(line.deflection, 3 * line.points, now);
      const points = Array.from({ length: line.points }, (_, j) => {
        const s = j / (line.points - 1);
        return [0, 1, 2].map(a => (1 - s) * ends[a] + s * ends[3 + a] + magnify * off[3 * j + a]);
      });
      const largest = Math.max(...points.map((_, j) => Math.hypot(off[3 * j], off[3 * j + 1], off[3 * j + 2])));
      return { line, points, largest, tension: between(line.tension, line.points - 1, now), angles: between(line.angles, 2, now) };
    });
    const bodies = run.bodies.map(body => ({ ...body, q: body.turn ? between(body.turn, 4, now) : null }));
    const all = lines.flatMap(one => one.points), ends = lines.flatMap(one => [one.points[0], one.points.at(-1)]);
    const apart = Math.max(...ends.flatMap(p => ends.map(q => Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]))));
    const reach = control("follow").checked ? apart : run.longest;
    const middle = [0, 1, 2].map(a => { const v = all.map(p => p[a]); return 0.5 * (Math.min(...v) + Math.max(...v)); });
    return { lines, bodies, reach, middle };
  };

  // A body at the end of a line or of several: `held` has the attachments in pixels, each with its lever's direction.
  const drawBody = (pen, body, held, axis) => {
    const flat = v => [v[axis], v[2]]; // right, down
    const turned = v => flat(body.q ? rotate(body.q, v) : v);
    const centres = held.map(({ at, lever }) => { const arm = body.q ? turned(lever) : [0, 0]; return at.map((x, j) => x - LEVER * arm[j]); });
    const [cx, cy] = [0, 1].map(j => centres.reduce((sum, c) => sum + c[j], 0) / centres.length);
    pen.lineWidth = 1.2; pen.strokeStyle = colours.ink; pen.fillStyle = colours.panel;
    if (!body.q) { pen.beginPath(); pen.arc(cx, cy, 5, 0, 7); pen.fill(); pen.stroke(); return [cx, cy]; }
    for (const { at } of held) { pen.beginPath(); pen.moveTo(cx, cy); pen.lineTo(...at); pen.stroke(); }
    const corner = k => { const [u, v] = turned([0, 1, 2].map(a => (k >> a) & 1 ? HALF : -HALF)); return [cx + u, cy + v]; };
    for (let k = 0; k < 8; k++) for (let a = 0; a < 3; a++) if (!((k >> a) & 1)) {
      pen.beginPath(); pen.moveTo(...corner(k)); pen.lineTo(...corner(k | (1 << a))); pen.stroke();
    }
    ["x", "y", "z"].forEach((name, a) => {
      const [u, v] = turned([0, 1, 2].map(b => (a === b ? 2 * HALF : 0)));
      pen.strokeStyle = colours[name]; pen.lineWidth = 2;
      pen.beginPath(); pen.moveTo(cx, cy); pen.lineTo(cx + u, cy + v); pen.stroke();
    });
    return [cx, cy];
  };

  const drawScale = (pen, width, height, pixels) => {
    const wanted = 0.28 * width / pixels, ten = 10 ** Math.floor(Math.log10(wanted));
    const metres = ten * (wanted >= 5 * ten ? 5 : wanted >= 2 * ten ? 2 : 1), x = 14, y = height - 14;
    pen.strokeStyle = pen.fillStyle = colours.soft; pen.lineWidth = 1.5;
    pen.beginPath(); pen.moveTo(x, y - 4); pen.lineTo(x, y); pen.lineTo(x + metres * pixels, y); pen.lineTo(x + metres * pixels, y - 4); pen.stroke();
    pen.fillText(metres >= 1000 ? `${metres / 1000} km` : `${+metres.toPrecision(2)} m`, x + 6, y - 5);
  };

  const drawView = (canvas, axis, now) => {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio)) { canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio); }
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0); pen.clearRect(0, 0, width, height); pen.font = "12px system-ui, sans-serif";
    const margin = 48, pixels = (Math.min(width, height) - 2 * margin) / Math.max(now.reach, 1e-6);
    const put = p => [0.5 * width + pixels * (p[axis] - now.middle[axis]), 0.5 * height + pixels * (p[2] - now.middle[2])];
    pen.strokeStyle = colours.faint; pen.lineWidth = 1; pen.setLineDash([]);
    const [x0] = put([0, 0, 0]); // the local vertical
    pen.beginPath(); pen.moveTo(x0, 0); pen.lineTo(x0, height); pen.stroke();
    for (const { points, tension } of now.lines) {
      tension.forEach((pull, j) => {
        pen.setLineDash(pull > 0 ? [] : [4, 4]); pen.lineWidth = pull > 0 ? 2.4 : 1.4;
        pen.strokeStyle = pull > 0 ? tint(pull / run.tension) : colours.grey;
        pen.beginPath(); pen.moveTo(...put(points[j])); pen.lineTo(...put(points[j + 1])); pen.stroke();
      });
      pen.setLineDash([]);
    }
    now.bodies.forEach((body, b) => {
      const held = now.lines.flatMap(({ line, points }) =>
        [0, 1].filter(end => line.bodies[end] === b).map(end => ({ at: put(points.at(-end)), lever: line.levers[end] })));
      const [x, y] = drawBody(pen, body, held, axis);
      pen.fillStyle = colours.ink; pen.fillText(body.name, x + 24, y + 4);
    });
    pen.fillStyle = colours.soft; pen.textAlign = "right";
    pen.fillText(axis === 0 ? "flight →" : "against the orbit normal →", width - 8, 14); pen.textAlign = "left";
    pen.fillText("↓ Earth", 8, 14);
    drawScale(pen, width, height, pixels);
  };

  const digits = (value, count) => value.toLocaleString("en-US", { maximumSignificantDigits: count });
  const draw = () => {
    const at = place(), now = moment(at);
    canvases.forEach((canvas, view) => drawView(canvas, view, now));
    control("time").value = share; magnifiedBy.textContent = MAGNIFIED[+control("magnify").value];
    const degree = 180 / Math.PI;
    readout.textContent = [`${(at.t / run.clock.unit_s).toFixed(2)} ${run.clock.label}`, ...now.lines.map(one => {
      const low = Math.min(...one.tension), high = Math.max(...one.tension);
      const pull = one.tension.length > 1 ? `${digits(low, 3)} to ${digits(high, 3)} N` : `${digits(high, 3)} N`;
      const bow = one.tension.length > 1 ? ` · deflection ${digits(one.largest, 3)} m` : "";
      return `${one.line.name}: ${digits(one.line.out[at.k], 5)} m out · ${(degree * one.angles[0]).toFixed(1)}° in the plane, ` +
        `${(degree * one.angles[1]).toFixed(1)}° across it${bow} · tension ${high > 0 ? pull : "none"}`;
    })].join("  |  ");
  };

  const step = time => {
    if (!playing) return;
    const passed = Math.min(0.1, Math.max(0, time - before) / 1000), whole = +control("speed").value;
    before = time; held += passed;
    if (!still.matches || held >= 0.5) { // where motion is to be reduced: two still pictures a second
      share += (still.matches ? held : passed) / whole; held = 0;
      if (share >= 1) { share = 1; play(false); }
      draw();
    }
    if (playing) requestAnimationFrame(step);
  };
  const play = on => {
    if (on && share >= 1) share = 0;
    playing = on; control("play").textContent = on ? "Stop" : "Play";
    if (on) { before = performance.now(); held = 0; requestAnimationFrame(step); }
  };
  const go = to => { play(false); share = Math.min(1, Math.max(0, to)); draw(); };

  control("play").addEventListener("click", () => play(!playing));
  control("time").addEventListener("input", event => go(+event.target.value));
  for (const name of ["magnify", "follow"]) control(name).addEventListener("input", draw);
  figure.addEventListener("keydown", event => {
    if (event.target !== figure) return; // a control in focus has keys of its own
    const at = place(), here = at.part > 0.999 ? at.k + 1 : at.k;
    const moves = {
      " ": () => play(!playing), Home: () => go(0), End: () => go(1),
      ArrowRight: () => go(run.seconds[Math.min(last, here + 1)] / length),
      ArrowLeft: () => go(run.seconds[Math.max(0, at.part > 0.001 && at.part <= 0.999 ? at.k : here - 1)] / length),
    };
    if (moves[event.key]) { event.preventDefault(); moves[event.key](); }
  });
  control("magnify").value = Math.max(0, MAGNIFIED.indexOf(run.magnify));
  control("follow").checked = run.follow;
  const refresh = () => { readColours(); draw(); };
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", refresh);
  window.addEventListener("resize", draw);
  refresh();
})();
