// Curves of the contact of a pair: transmission error over the rotation, and the path or the lines of contact on the pinion's flank.
// Both have a cursor at the position of the view, and move it where they are pressed.
window.gearmeshCurves = function (parent, moveTo) {
  "use strict";

  const NAMES = "http://www.w3.org/2000/svg", WIDTH = 360, HEIGHT = 190, LEFT = 66, RIGHT = 12, TOP = 24, BOTTOM = 24, LINES_SHOWN = 20;
  // a loop takes a fifth of the time of Uint8Array.from with a function
  function floats(text) {
    const plain = atob(text), bytes = new Uint8Array(plain.length);
    for (let k = 0; k < plain.length; k++) bytes[k] = plain.charCodeAt(k);
    return new Float32Array(bytes.buffer);
  }

  function made(name, attributes, text) {
    const each = document.createElementNS(NAMES, name);
    for (const [key, value] of Object.entries(attributes)) each.setAttribute(key, String(value));
    if (text !== undefined) each.textContent = text;
    return each;
  }

  // ends of a scale, a little wider than the values
  function ends(values, least) {
    let low = Infinity, high = -Infinity;
    for (const value of values) if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
    if (low > high) return [0, 1];
    const spare = Math.max(0.06 * (high - low), least / 2);
    return [low - spare, high + spare];
  }

  const digits = (low, high) => Math.max(0, Math.min(6, 2 - Math.floor(Math.log10(Math.max(high - low, 1e-6)))));
  const shown = (value, count) => (Number(value.toFixed(count)) || 0).toFixed(count).replace("-", "−");

  function chart(title) {
    const figure = document.createElement("figure"), caption = document.createElement("figcaption");
    const svg = made("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": title });
    caption.textContent = title;
    figure.append(svg, caption);
    parent.append(figure);
    return { svg };
  }

  function axes(svg, [x0, x1], [y0, y1], across, upwards) {
    const x = (value) => LEFT + (value - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT);
    const y = (value) => HEIGHT - BOTTOM - (value - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM);
    svg.append(made("rect", { x: LEFT, y: TOP, width: WIDTH - LEFT - RIGHT, height: HEIGHT - TOP - BOTTOM, class: "axis", fill: "none" }));
    const [dx, dy] = [digits(x0, x1), digits(y0, y1)];
    svg.append(made("text", { x: LEFT, y: HEIGHT - BOTTOM + 17 }, shown(x0, dx)),
      made("text", { x: WIDTH - RIGHT, y: HEIGHT - BOTTOM + 17, "text-anchor": "end" }, shown(x1, dx)),
      made("text", { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - BOTTOM + 17, "text-anchor": "middle" }, across),
      made("text", { x: LEFT - 5, y: HEIGHT - BOTTOM, "text-anchor": "end" }, shown(y0, dy)),
      made("text", { x: LEFT - 5, y: TOP + 11, "text-anchor": "end" }, shown(y1, dy)),
      made("text", { x: LEFT, y: 16 }, upwards));
    return { x, y };
  }

  // `jumps`: positions from which the next one is not reached along the curve
  function path(xs, ys, scale, jumps = []) {
    let text = "", open = false;
    for (let k = 0; k < xs.length; k++) {
      const known = Number.isFinite(xs[k]) && Number.isFinite(ys[k]);
      if (known) text += `${open ? "L" : "M"}${scale.x(xs[k]).toFixed(2)},${scale.y(ys[k]).toFixed(2)}`;
      open = known && !jumps.includes(k);
    }
    return text;
  }

  const degrees = (values) => Array.from(values, (value) => value * 180 / Math.PI);

  // points of a flank as distance along the axis and from it; of a part that slides, across and up
  function onFlank(points, slides) {
    const along = [], out = [];
    for (let k = 0; k + 2 < points.length; k += 3) {
      along.push(points[k + 2]);
      out.push(slides ? points[k] : Math.hypot(points[k], points[k + 1]));
    }
    return [along, out];
  }

  // lines of contact (P) in the frame of a member, each as points (N, 3); a turn about its axis moves none of them on the flank
  function ownLines(pair, index, member) {
    const points = floats(pair.lines), turns = floats(pair.turns[index]), size = points.length / turns.length;
    const [r, t] = [member.rotation, member.translation], [ex, ey] = member.eccentricity;
    return Array.from(turns, (turn, k) => {
      const angle = member.travel ? 0 : member.sign * (turn - member.zero), [c, s] = [Math.cos(angle), Math.sin(angle)], own = [];
      for (let j = k * size; j < (k + 1) * size; j += 3) {
        const d = [points[j] - t[0], points[j + 1] - t[1], points[j + 2] - t[2]];
        const [x, y, z] = [0, 1, 2].map((axis) => r[0][axis] * d[0] + r[1][axis] * d[1] + r[2][axis] * d[2]);
        own.push(c * x + s * y - ex, c * y - s * x - ey, z);
      }
      return own;
    });
  }

  let now = null;

  // the position nearest to where a chart is pressed; `away`: distance of each position from there, in units of the chart
  function seek(svg, count, away, event) {
    const box = svg.getBoundingClientRect();
    const [x, y] = [(event.clientX - box.left) / box.width * WIDTH, (event.clientY - box.top) / box.height * HEIGHT];
    let best = 0, least = Infinity;
    for (let k = 0; k < count; k++) {
      const here = away(k, x, y);
      if (here < least) [best, least] = [k, here];
    }
    moveTo(count > 1 ? best / (count - 1) : 0);
  }

  // distance of a point from a curve, in units of the chart
  function distance(xs, ys, scale, x, y) {
    let least = Infinity;
    for (let k = 0; k < xs.length; k++) {
      const [ax, ay] = [scale.x(xs[k]), scale.y(ys[k])], last = Math.min(k + 1, xs.length - 1);
      const [dx, dy] = [scale.x(xs[last]) - ax, scale.y(ys[last]) - ay], size = dx * dx + dy * dy;
      const part = size > 0 ? Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / size, 0), 1) : 0;
      const here = Math.hypot(ax + part * dx - x, ay + part * dy - y);
      if (here < least) least = here;
    }
    return least;
  }

  function show(pair, members, pinned) {
    parent.replaceChildren();
    now = null;
    if (!pair) return;
    const phi1 = degrees(floats(pair.phi1)), te = Array.from(floats(pair.te)), flank = pair.flanks[0];
    const before = pinned && { phi1: degrees(floats(pinned.phi1)), te: Array.from(floats(pinned.te)), flank: pinned.flanks[0], jumps: pinned.jumps };

    const first = chart(pair.title ?? `Transmission error of a tooth pair, ${pair.name}`);
    const every = before ? [...te, ...before.te] : te;
    const scale = axes(first.svg, ends(before ? [...phi1, ...before.phi1] : phi1, 1e-3), ends(every, 0.01), "φ₁ (°)", pair.te_unit);
    if (before) first.svg.append(made("path", { d: path(before.phi1, before.te, scale), class: "pinned" }));
    first.svg.append(made("path", { d: path(phi1, te, scale), class: "line" }));
    const line = made("line", { y1: TOP, y2: HEIGHT - BOTTOM, class: "cursor" }), reading = made("text", { x: WIDTH - RIGHT, y: 16, "text-anchor": "end", class: "reading" });
    first.svg.append(line, reading);

    const pressed = (svg, away) => {
      svg.addEventListener("pointerdown", (event) => { svg.setPointerCapture(event.pointerId); seek(svg, phi1.length, away, event); });
      svg.addEventListener("pointermove", (event) => { if (event.buttons) seek(svg, phi1.length, away, event); });
    };
    const across = (k, x) => Math.abs(scale.x(phi1[k]) - x);
    // a train has no flank of its own
    if (!flank) {
      pressed(first.svg, across);
      now = { pair, phi1, te, scale, line, reading };
      return;
    }
    const member = members[pair.members[0]];
    const lines = ownLines(pair, pair.members[0], member).map((line) => onFlank(line, Boolean(member.travel)));
    const isLine = lines.some(([at]) => Number.isFinite(at[0]));
    const second = chart(`${isLine ? "Lines" : "Path"} of contact on the ${member.name}'s flank`);
    const [rows, columns] = flank.shape, [along, out] = onFlank(floats(flank.points), Boolean(member.travel));
    const [px, py] = onFlank(floats(flank.contact), Boolean(member.travel));
    const border = [];
    for (let j = 0; j < columns; j++) border.push(j);
    for (let i = 1; i < rows; i++) border.push(i * columns + columns - 1);
    for (let j = columns - 2; j >= 0; j--) border.push((rows - 1) * columns + j);
    for (let i = rows - 2; i >= 0; i--) border.push(i * columns);
    const places = axes(second.svg, ends(along, 1e-3), ends(out, 1e-3), "along the axis (mm)", member.travel ? "height (mm)" : "radius (mm)");
    second.svg.append(made("path", { d: path(border.map((k) => along[k]), border.map((k) => out[k]), places), class: "edge" }));
    // which point of a line of contact counts as the contact means nothing: lines are drawn whole
    if (isLine) {
      const step = Math.max(1, Math.round(lines.length / LINES_SHOWN));
      lines.forEach(([x, y], k) => { if (k % step === 0) second.svg.append(made("path", { d: path(x, y, places), class: "contact" })); });
    }
    if (before && !isLine) {
      const [bx, by] = onFlank(floats(before.flank.contact), Boolean(member.travel));
      second.svg.append(made("path", { d: path(bx, by, places, before.jumps), class: "pinned" }));
    }
    if (!isLine) second.svg.append(made("path", { d: path(px, py, places, pair.jumps), class: "line" }));
    const spot = made("circle", { r: 5, class: "spot" }), touched = made("path", { class: "now" });
    second.svg.append(touched, spot);

    const touching = (k) => Number.isFinite(lines[k]?.[0][0]) ? lines[k] : [[px[k]], [py[k]]];
    pressed(first.svg, across);
    pressed(second.svg, (k, x, y) => distance(...touching(k), places, x, y));
    now = { pair, phi1, te, scale, line, lines, touched, px, py, places, spot, reading };
  }

  function follow(share) {
    if (!now) return;
    const k = Math.round(share * (now.phi1.length - 1));
    const x = now.scale.x(now.phi1[k]);
    now.line.setAttribute("x1", x);
    now.line.setAttribute("x2", x);
    now.reading.textContent = `${Number.isFinite(now.te[k]) ? `${shown(now.te[k], 3)} ${now.pair.te_unit}` : "no contact"} at ${shown(now.phi1[k], 2)}°`;
    if (!now.spot) return;
    const [lx, ly] = now.lines[k] ?? [[], []], isLine = Number.isFinite(lx[0]), known = !isLine && Number.isFinite(now.px[k]);
    now.touched.setAttribute("d", isLine ? path(lx, ly, now.places) : "");
    now.spot.setAttribute("visibility", known ? "visible" : "hidden");
    if (known) {
      now.spot.setAttribute("cx", now.places.x(now.px[k]));
      now.spot.setAttribute("cy", now.places.y(now.py[k]));
    }
  }

  return { show, follow };
};
