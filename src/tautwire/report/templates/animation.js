"use strict";
/* The pantograph under the line: a canvas, no library. Heights are exaggerated by one factor for
   everything that is drawn above the track; the pantograph itself is a symbol, not to scale. */
(async () => {
  const holder = document.getElementById("film");
  if (!holder) return;

  const INK = "#16202b", SOFT = "#55616e", FAINT = "#c3cbd3", GRID = "#e3e7eb";
  const CONTACT = "#0b3d63", SLACK = "#d55e00", BAND = "#eef3f7";
  const COLOURS = ["#0b3d63", "#b34700", "#006b4e", "#8a3a6b"];
  const LEFT = 62, RIGHT = 18, TOP = 26, GAP = 34, BOTTOM = 40, ROOF = 26;
  const FONT = '12px system-ui, -apple-system, "Segoe UI", Roboto, Arial, sans-serif';

  /* ---- data ------------------------------------------------------------------------- */
  const inflate = (bytes) => new Response(
    new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
  const unpack = async ({ dtype, data, low, step, row }) => {
    const buffer = await inflate(Uint8Array.from(atob(data), (c) => c.charCodeAt(0)));
    const view = new { f4: Float32Array, u1: Uint8Array }[dtype](buffer);
    if (step === undefined) return view;
    for (let i = row; i < view.length; i += 1) view[i] += view[i - row]; // changes, modulo 256
    return Float32Array.from(view, (v) => low + step * v);
  };
  const unpackAll = async (item) => {
    if (Array.isArray(item)) return Promise.all(item.map(unpackAll));
    if (item === null || typeof item !== "object") return item;
    if ("dtype" in item) return unpack(item);
    const entries = Object.entries(item).map(async ([k, v]) => [k, await unpackAll(v)]);
    return Object.fromEntries(await Promise.all(entries));
  };
  if (typeof DecompressionStream === "undefined") {
    holder.textContent = "The animation needs a browser of 2023 or later.";
    return;
  }
  const films = await unpackAll(JSON.parse(document.getElementById("film-data").textContent));

  const below = (values, target) => {
    let low = 0, high = values.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (values[middle] <= target) low = middle; else high = middle;
    }
    return low;
  };
  const sample = (times, values, time) => {
    const i = below(times, time), j = Math.min(i + 1, times.length - 1);
    const span = times[j] - times[i];
    const part = span > 0 ? Math.min(1, Math.max(0, (time - times[i]) / span)) : 0;
    return values[i] * (1 - part) + values[j] * part;
  };

  /* ---- state ------------------------------------------------------------------------ */
  const canvas = holder.querySelector("canvas");
  const pen = canvas.getContext("2d");
  const part = (name) => holder.querySelector(`[data-part="${name}"]`);
  const state = { film: films[0], time: 0, playing: false, last: 0, width: 0, height: 0 };
  const setting = (name) => Number(part(name).value);

  const isOn = (p, time) => p.time.length > 1 && time >= p.time[0]
    && time <= p.time[p.time.length - 1];
  const active = () => state.film.pantographs.filter((p) => isOn(p, state.time));
  const stateOf = (p) => ({
    x: sample(p.time, p.position, state.time),
    wire: sample(p.time, p.wire, state.time),
    head: sample(p.time, p.head, state.time),
    force: sample(p.rawTime, p.raw, state.time),
    filtered: sample(p.time, p.filtered, state.time),
    stages: p.stages.map((stage) => sample(p.time, stage, state.time)),
  });

  /* ---- view ------------------------------------------------------------------------- */
  const cameraX = () => {
    const { film } = state, length = setting("length");
    const first = film.supports[0], last = film.supports[film.supports.length - 1];
    const ends = [first - 0.03 * length, last + 0.03 * length];
    const wanted = part("follow").value;
    const p = film.pantographs.find((q) => q.name === wanted) || film.pantographs[0];
    const x = p && p.time.length > 1 ? sample(p.time, p.position, state.time) : first;
    const room = ends[1] - ends[0];
    if (length >= room) return [ends[0], ends[0] + room];
    const start = Math.min(Math.max(x - length / 2, ends[0]), ends[1] - length);
    return [start, start + length];
  };
  const viewOf = () => {
    const [start, end] = cameraX(), { film } = state;
    const wide = state.width - LEFT - RIGHT;
    const sceneHeight = Math.round((state.height - TOP - GAP - BOTTOM) * 0.6);
    const bottom = TOP + sceneHeight, traceTop = bottom + GAP;
    const scale = wide / (end - start), lift = scale * setting("exaggeration");
    const zero = TOP + 0.62 * sceneHeight;
    const [low, high] = film.forceRange;
    const traceBottom = state.height - BOTTOM;
    return {
      start, end, wide, bottom, traceTop, traceBottom, scale, lift, low, high,
      x: (x) => LEFT + (x - start) * scale,
      z: (z) => zero - (z - film.reference) * lift,
      f: (f) => traceBottom - (f - low) / (high - low) * (traceBottom - traceTop),
    };
  };

  const line = (points, colour, width, dash = []) => {
    pen.beginPath();
    points.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.strokeStyle = colour; pen.lineWidth = width; pen.setLineDash(dash);
    pen.stroke(); pen.setLineDash([]);
  };
  const label = (text, x, y, align = "center", colour = SOFT) => {
    pen.fillStyle = colour; pen.textAlign = align; pen.fillText(text, x, y);
  };
  const clipped = (view, top, bottom, work) => {
    pen.save(); pen.beginPath(); pen.rect(LEFT, top, view.wide, bottom - top); pen.clip();
    work(); pen.restore();
  };

  /* ---- the line --------------------------------------------------------------------- */
  const shapeAt = ({ x, still, moved, first, count }) => {
    const { time } = state.film.frames;
    const i = below(time, state.time), j = Math.min(i + 1, time.length - 1);
    const span = time[j] - time[i];
    const w = span > 0 ? Math.min(1, Math.max(0, (state.time - time[i]) / span)) : 0;
    const lift = (frame, k) => {
      const at = k - first[frame];
      return at >= 0 && at < count ? moved[frame * count + at] : 0;
    };
    return Array.from(x, (v, k) => [v, still[k] + lift(i, k) * (1 - w) + lift(j, k) * w]);
  };
  /* Between two stored shapes the wire at the pantograph is known exactly: bend it there. */
  const REACH = 3, NEAR = 0.3;
  const bent = (points, pantographs) => {
    const known = [];
    pantographs.forEach(({ at }) => {
      if (at.x < points[0][0] || at.x > points[points.length - 1][0]) return;
      const error = at.wire - heightOn(points, at.x);
      if (Math.abs(error) > NEAR) return;
      points.forEach((p) => { p[1] += error * Math.max(0, 1 - Math.abs(p[0] - at.x) / REACH); });
      known.push([at.x, at.wire]);
    });
    return points.concat(known).sort((a, b) => a[0] - b[0]);
  };
  const shapes = (pantographs) => state.film.frames.wires.map((wire) => {
    const points = shapeAt(wire);
    return wire.role === "contact" ? bent(points, pantographs) : points;
  });
  const heightOn = (points, x) => {
    let low = 0, high = points.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (points[middle][0] <= x) low = middle; else high = middle;
    }
    const [a, b] = [points[low], points[high]];
    return b[0] > a[0] ? a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]) : a[1];
  };

  const drawSupports = (view) => {
    state.film.supports.forEach((x, i) => {
      if (x < view.start - 1 || x > view.end + 1) return;
      const px = view.x(x);
      line([[px, TOP], [px, view.bottom]], FAINT, 5);
      label(`support ${state.film.marks[i]}`, px, TOP - 9);
    });
  };
  const drawDroppers = (view, wires) => {
    const { droppers, dropperWires, slack, frames } = state.film;
    const frame = below(frames.time, state.time), count = droppers.length;
    const bit = (k) => (slack[k >> 3] >> (7 - (k & 7))) & 1;
    droppers.forEach((x, i) => {
      if (x < view.start || x > view.end) return;
      const isSlack = slack.length > 0 && bit(frame * count + i) > 0;
      const px = view.x(x), top = view.z(heightOn(wires[dropperWires[2 * i]], x));
      const foot = view.z(heightOn(wires[dropperWires[2 * i + 1]], x));
      if (isSlack) {
        const bow = [[px, top], [px + 4, (2 * top + foot) / 3], [px + 4, (top + 2 * foot) / 3]];
        line([...bow, [px, foot]], SLACK, 2, [4, 3]);
      } else {
        line([[px, top], [px, foot]], "#7d8894", 1.2);
      }
    });
  };
  const drawWires = (view, wires) => {
    const toScreen = ([x, z]) => [view.x(x), view.z(z)];
    const seen = ([x]) => x > view.start - 15 && x < view.end + 15;
    const drawn = state.film.frames.wires.map((wire, i) => [wire, wires[i]]);
    drawn.filter(([{ role }]) => role === "contact").forEach(([{ x, still }]) => {
      const rest = Array.from(x, (v, k) => [v, still[k]]);
      line(rest.filter(seen).map(toScreen), "#9aa5b0", 1, [5, 4]);
    });
    drawn.forEach(([{ role }, points]) => {
      const isContact = role === "contact";
      line(points.filter(seen).map(toScreen), isContact ? CONTACT : INK, isContact ? 2.6 : 1.6);
    });
    drawn.filter(([{ role }]) => role === "messenger").forEach(([, points]) => {
      state.film.supports.forEach((x) => {
        if (x < view.start || x > view.end) return;
        if (x < points[0][0] || x > points[points.length - 1][0]) return;
        pen.fillStyle = INK;
        pen.beginPath(); pen.arc(view.x(x), view.z(heightOn(points, x)), 3.2, 0, 7); pen.fill();
      });
    });
  };
  const drawScales = (view) => {
    const fitting = (sizes, scale, least) => sizes.find((size) => size * scale >= least)
      || sizes[sizes.length - 1];
    const metres = fitting([2, 5, 10, 20, 50, 100, 200], view.scale, 55);
    const x = state.width - RIGHT - 14, y = view.bottom - ROOF - 12;
    line([[x - metres * view.scale, y], [x, y]], INK, 2);
    label(`${metres} m`, x - metres * view.scale / 2, y - 6, "center", INK);
    const millimetres = fitting([10, 20, 50, 100, 200, 500, 1000], view.lift / 1000, 26);
    const tall = millimetres / 1000 * view.lift;
    line([[x, y], [x, y - tall]], INK, 2);
    label(`${millimetres} mm`, x - 6, y - tall + 4, "right", INK);
    label(`heights × ${setting("exaggeration")}`, LEFT + 8, y + 2, "left");
  };

  /* ---- the pantograph --------------------------------------------------------------- */
  const drawPantograph = (view, { at, colour, backwards }) => {
    const x = view.x(at.x), head = view.z(at.head), roof = view.bottom - ROOF;
    const rest = head + at.stages[0] * view.lift;
    const frames = at.stages.slice(1).map((h, i) => rest + 24 * (i + 1) - h * view.lift);
    const foot = frames.length ? frames[0] : head + 20;
    const side = backwards ? 1 : -1;
    line([[x - 22, head + 5], [x - 14, head], [x + 14, head], [x + 22, head + 5]], colour, 3.2);
    const coil = Array.from({ length: 9 }, (_, k) =>
      [x + (k % 8 === 0 ? 0 : k % 2 ? 4 : -4), head + (foot - head) * k / 8]);
    line(coil, colour, 1.2);
    line([[x - 9, foot], [x + 9, foot]], colour, 4);
    const knee = [x + side * 40, (foot + roof) / 2 + 4];
    line([[x, foot], knee, [x + side * 6, roof]], colour, 2.4);
    pen.fillStyle = colour;
    pen.beginPath(); pen.arc(knee[0], knee[1], 3, 0, 7); pen.fill();
    if (at.head < at.wire - 1e-4) {
      line([[x, head - 3], [x, view.z(at.wire)]], SLACK, 2, [2, 2]);
    }
  };
  const drawRoof = (view, pantographs) => {
    const y = view.bottom - ROOF;
    line([[LEFT, y + 1], [LEFT + view.wide, y + 1]], FAINT, 2);
    pantographs.forEach(({ at, colour, name }) => {
      if (state.film.pantographs.length > 1) label(name, view.x(at.x), y + 17, "center", colour);
    });
  };

  /* ---- the force -------------------------------------------------------------------- */
  const niceStep = (range, count) => {
    const rough = range / count, power = 10 ** Math.floor(Math.log10(rough));
    return power * [1, 2, 5, 10].find((m) => m * power >= rough);
  };
  const drawTraceFrame = (view) => {
    const { film } = state;
    const [a, b] = film.section.map((x) => Math.min(Math.max(x, view.start), view.end));
    pen.fillStyle = BAND;
    pen.fillRect(view.x(a), view.traceTop, (b - a) * view.scale, view.traceBottom - view.traceTop);
    const step = niceStep(view.high - view.low, 5);
    for (let f = Math.ceil(view.low / step) * step; f <= view.high; f += step) {
      line([[LEFT, view.f(f)], [LEFT + view.wide, view.f(f)]], Math.abs(f) < 1e-9 ? SOFT : GRID, 1);
      label(`${Math.round(f)}`, LEFT - 8, view.f(f) + 4, "right");
    }
    const far = niceStep(view.end - view.start, 8);
    for (let x = Math.ceil(view.start / far) * far; x <= view.end; x += far) {
      line([[view.x(x), view.traceBottom], [view.x(x), view.traceBottom + 5]], SOFT, 1);
      label(`${Math.round(x)}`, view.x(x), view.traceBottom + 18);
    }
    film.supports.filter((x) => x >= view.start && x <= view.end).forEach((x) =>
      line([[view.x(x), view.traceTop], [view.x(x), view.traceBottom]], GRID, 1.5));
    label("position [m]", LEFT + view.wide, view.traceBottom + 34, "right");
    pen.save(); pen.translate(14, (view.traceTop + view.traceBottom) / 2); pen.rotate(-Math.PI / 2);
    label("contact force [N]", 0, 0); pen.restore();
  };
  const history = (view, times, positions, values, from, to) => {
    const points = [];
    const last = below(times, to);
    for (let k = from === null ? 0 : below(times, from); k <= last; k += 1) {
      const x = positions[k];
      if (x >= view.start - 2 && x <= view.end + 2) points.push([view.x(x), view.f(values[k])]);
    }
    return points;
  };
  const drawTraces = (view) => {
    state.film.pantographs.forEach((p, i) => {
      if (p.time.length < 2) return;
      const end = p.time[p.time.length - 1], colour = COLOURS[i % COLOURS.length];
      line(history(view, p.time, p.position, p.filtered, null, end), FAINT, 1.2, i ? [6, 4] : []);
      if (state.time < p.time[0]) return;
      line(history(view, p.rawTime, p.rawPosition, p.raw, null, state.time), "#94a0ac", 0.9);
      line(history(view, p.time, p.position, p.filtered, null, state.time), colour, 2.2, i ? [6, 3] : []);
    });
    active().forEach((p) => {
      const at = stateOf(p), colour = COLOURS[state.film.pantographs.indexOf(p) % COLOURS.length];
      line([[view.x(at.x), TOP], [view.x(at.x), view.traceBottom]], colour, 0.8, [2, 4]);
      pen.fillStyle = colour;
      pen.beginPath(); pen.arc(view.x(at.x), view.f(at.filtered), 4.5, 0, 7); pen.fill();
    });
  };

  /* ---- a picture -------------------------------------------------------------------- */
  const present = () => active().map((p) => ({
    name: p.name,
    at: stateOf(p),
    colour: COLOURS[state.film.pantographs.indexOf(p) % COLOURS.length],
    backwards: p.position[p.position.length - 1] < p.position[0],
  }));
  const readout = (shown) => {
    const { film } = state;
    const texts = shown.map(({ name, at }) => {
      const span = film.supports.filter((x) => x <= at.x).length;
      return `${name}: span ${span}, x = ${at.x.toFixed(1)} m, force ${at.filtered.toFixed(0)} N `
        + `(${film.filterShort}), ${at.force.toFixed(0)} N unfiltered`;
    });
    part("readout").textContent = `t = ${state.time.toFixed(2)} s · `
      + (texts.join(" · ") || "no pantograph on the line");
  };
  const draw = () => {
    const ratio = window.devicePixelRatio || 1;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, state.width, state.height);
    pen.font = FONT; pen.lineJoin = "round";
    const view = viewOf(), shown = present(), wires = shapes(shown);
    clipped(view, 0, view.bottom, () => {
      drawSupports(view);
      drawDroppers(view, wires);
      drawWires(view, wires);
      drawRoof(view, shown);
      shown.forEach((item) => drawPantograph(view, item));
      drawScales(view);
    });
    drawTraceFrame(view);
    clipped(view, TOP, view.traceBottom + 1, () => drawTraces(view));
    readout(shown);
  };

  /* ---- controls --------------------------------------------------------------------- */
  const limits = () => {
    const { time } = state.film.frames;
    return [time[0], time[time.length - 1]];
  };
  const show = () => {
    const [first, last] = limits();
    part("scrub").value = String(1000 * (state.time - first) / (last - first || 1));
    part("scrub").setAttribute("aria-valuetext", `${state.time.toFixed(2)} seconds`);
    part("exaggeration-value").textContent = `× ${part("exaggeration").value}`;
    part("length-value").textContent = `${part("length").value} m`;
    draw();
  };
  const setPlaying = (playing) => {
    state.playing = playing;
    state.last = 0;
    part("play").textContent = playing ? "❚❚ Pause" : "▶ Play";
    if (playing) {
      if (state.time >= limits()[1]) state.time = limits()[0];
      requestAnimationFrame(advance);
    }
  };
  const advance = (now) => {
    if (!state.playing) return;
    const passed = state.last ? Math.min(0.1, (now - state.last) / 1000) : 0;
    state.last = now;
    state.time = Math.min(limits()[1], state.time + passed * setting("rate"));
    show();
    if (state.time >= limits()[1]) setPlaying(false); else requestAnimationFrame(advance);
  };
  const step = (seconds) => {
    setPlaying(false);
    state.time = Math.min(Math.max(state.time + seconds, limits()[0]), limits()[1]);
    show();
  };
  const load = (index) => {
    state.film = films[index];
    const { film } = state, follow = part("follow");
    follow.replaceChildren(...film.pantographs.map((p) => new Option(p.name, p.name)));
    part("length").max = String(Math.ceil(film.supports[film.supports.length - 1]
      - film.supports[0]));
    state.time = film.startTime;
    show();
  };
  const resize = () => {
    const box = canvas.getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
    if (!box.width) return;
    state.width = box.width; state.height = box.height;
    canvas.width = Math.round(box.width * ratio); canvas.height = Math.round(box.height * ratio);
    draw();
  };

  part("play").addEventListener("click", () => setPlaying(!state.playing));
  part("scrub").addEventListener("input", () => {
    const [first, last] = limits();
    setPlaying(false);
    state.time = first + setting("scrub") / 1000 * (last - first);
    show();
  });
  ["exaggeration", "length", "follow"].forEach((name) => part(name).addEventListener("input", show));
  if (part("film")) part("film").addEventListener("input", () => load(setting("film")));
  canvas.addEventListener("keydown", (event) => {
    const keys = { ArrowRight: 0.02, ArrowLeft: -0.02, PageDown: 0.5, PageUp: -0.5 };
    if (event.key === " ") setPlaying(!state.playing);
    else if (event.key in keys) step(keys[event.key]);
    else return;
    event.preventDefault();
  });
  resize();
  load(0);
  new ResizeObserver(resize).observe(canvas);
})();
