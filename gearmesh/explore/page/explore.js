// The page of gearmesh explore. It keeps what was set (`state`), its history and its link; a process of the program computes all
// figures, curves and meshes. Every change asks anew; what comes for an older question is not shown.
(function () {
  "use strict";

  const element = (id) => document.getElementById(id);
  const create = (name, fields = {}) => Object.assign(document.createElement(name), fields);
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const STORED = "gearmesh-explore", MAX_HISTORY = 200, SLOW_MS = 500, AGAIN_MS = 1000, DIGITS = 4, CHANGE_DIGITS = 5, SET_DIGITS = 10, DERIVED_DIGITS = 6;
  const UNITS = { um: "µm", deg: "°", arcsec: "arcsec" };

  // ---------------------------------------------------------------- the program

  let socket = null, entered = false, count = 0, opened = null;
  const asked = new Map();

  function connect() {
    socket = new WebSocket(`ws://${location.host}/socket`);
    socket.addEventListener("open", () => {
      const token = new URLSearchParams(location.search).get("token");
      socket.send(JSON.stringify({ do: "enter", token, secret: localStorage.getItem(STORED) }));
    });
    socket.addEventListener("message", (event) => take(JSON.parse(event.data)));
    socket.addEventListener("close", (event) => {
      asked.clear();
      busy = null;
      if (event.code === 4403 || (!entered && event.code === 4429)) return;
      trouble(entered ? "The program has ended, or cannot be reached. What was set stays here and in the link." : "The program cannot be reached.");
      setTimeout(connect, AGAIN_MS);
    });
  }

  function ask(what, fields = {}) {
    if (!entered || socket.readyState !== WebSocket.OPEN) return null;
    const id = ++count;
    // what is stale has no end
    const ended = { show: ["show", "range"], file: ["range"] }[what] ?? [];
    for (const [old, { what: before }] of asked) if (ended.includes(before)) asked.delete(old);
    asked.set(id, { what, ...fields });
    socket.send(JSON.stringify({ do: what, id, ...fields }));
    return id;
  }

  // a trouble that is not `lasting` is over with the next change
  let lasting = true;
  function trouble(line) {
    lasting = true;
    element("trouble").textContent = line;
    element("trouble").hidden = !line;
  }

  const answers = {
    entered(message) {
      const first = !entered;
      entered = true;
      localStorage.setItem(STORED, message.secret);
      history.replaceState(null, "", location.pathname + location.hash);
      opened = message.opened;
      trouble("");
      if (state) show(null);
      else if (first) begin();
    },
    wrong(message) { trouble(message.line); },
    worker(message) { trouble(message.works ? "" : message.line); },
    start: showStart,
    opened(message) { replace({ from: message.from, keys: message.keys }, null); },
    design: takeDesign,
    figures: takeFigures,
    curves: takeCurves,
    scene: takeScene,
    range: takeRange,
    file(message) { save(message.name, bytes(message.content)); },
    refused: takeRefusal,
    progress(message) { if (busy) busy.doing = `${message.doing}, ${Math.round(100 * message.share)} %`; },
    end(message) {
      asked.delete(message.id);
      if (busy?.id === message.id) {
        busy = null;
        element("status").textContent = "";
        askRange();
      }
      if (filing === message.id) {
        filing = null;
        element("status").textContent = "";
        // the file came before the range of the key in use
        rangeAsked = null;
        askRange();
      }
    },
  };

  let heard = () => {};
  const OF_SHOW = ["design", "figures", "curves", "scene"];

  function take(message) {
    if (OF_SHOW.includes(message.type) && message.id !== latest) return;
    answers[message.type]?.(message);
    if (message.id === latest) heard(message.type);
  }

  // ---------------------------------------------------------------- state, history, link

  let state = null, title = "gearmesh explore", anew = true, latest = null, busy = null, filing = null, past = [], place = -1, merging = null;

  const encode = (value) => btoa(String.fromCharCode(...new TextEncoder().encode(JSON.stringify(value))))
    .replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  function decode(text) {
    try {
      const value = JSON.parse(new TextDecoder().decode(bytes(text.replaceAll("-", "+").replaceAll("_", "/"))));
      return typeof value.from === "string" && Object.prototype.toString.call(value.keys) === "[object Object]" ? value : null;
    } catch {
      return null;
    }
  }

  function begin() {
    const linked = location.hash.length > 1 ? decode(location.hash.slice(1)) : null;
    if (location.hash.length > 1 && !linked) trouble("The link has no state that can be read.");
    if (linked) replace(linked, null);
    else if (opened) replace(opened, null);
    else ask("start");
  }

  // other gears: the history begins anew, the camera too
  function replace(given, last) {
    past = [];
    place = -1;
    rowsOf = null;
    chosen = null;
    anew = true;
    figures = [];
    unpin();
    commit(given, last);
  }

  // `live` changes of one key, as by a slider, are one step of the history
  function commit(next, last, live = false) {
    state = next;
    if (live && merging === last && place >= 0) past[place] = next;
    else {
      past = [...past.slice(Math.max(0, place + 2 - MAX_HISTORY), place + 1), next];
      place = past.length - 1;
    }
    merging = live ? last : null;
    show(last);
  }

  function step(by) {
    if (!past[place + by]) return;
    if (!lasting) trouble("");
    place += by;
    state = past[place];
    merging = null;
    show(null);
  }

  // kinds and samples in the place of the gears, to which a button leads back
  function starting(begun) {
    element("start").hidden = !begun;
    element("work").hidden = begun;
    element("tools").hidden = begun && !state;
    for (const id of ["undo", "redo", "pin", "unpin", "save", "saved-member"]) (element(id).closest("label") ?? element(id)).classList.toggle("away", begun);
    element("other").textContent = begun ? "Back to the gears" : "Other gears";
    element("title").textContent = document.title = begun ? "gearmesh explore" : title;
  }

  function show(last) {
    starting(false);
    element("undo").disabled = place <= 0;
    element("redo").disabled = place >= past.length - 1;
    history.replaceState(null, "", `${location.pathname}#${encode(state)}`);
    latest = ask("show", { from: state.from, keys: state.keys, last, good: typeof values[last] === "number" ? values[last] : undefined, have: scene ? held : [], rows: rowsOf });
    if (latest === null) return;
    busy = { id: latest, doing: "", since: performance.now() };
  }

  setInterval(() => {
    if (busy && performance.now() - busy.since > SLOW_MS) element("status").textContent = busy.doing ? `Working: ${busy.doing}` : "Working";
  }, 100);

  function set(key, value, live = false) {
    const keys = { ...state.keys };
    if (value === undefined) delete keys[key];
    else keys[key] = value;
    if (JSON.stringify(keys) === JSON.stringify(state.keys)) return;
    if (!lasting) trouble("");
    commit({ ...state, keys }, key, live);
  }

  // ---------------------------------------------------------------- keys

  let rowsOf = null, rows = [], values = {}, members = [], memberWords = [], errorKeys = [], shownRows = new Map(), chosen = null, ranges = new Map(), rangeAsked = null;

  function takeDesign(message) {
    title = message.title;
    if (!element("work").hidden) element("title").textContent = document.title = title;
    values = message.values;
    members = message.members;
    memberWords = message.words ?? members;
    errorKeys = message.errors;
    const saved = element("saved-member"), before = saved.value, parts = [...members, "all"];
    options(saved, parts.map((name) => [name, name]));
    if (parts.includes(before)) saved.value = before;
    if (message.rows) {
      rows = message.rows;
      rowsOf = message.of;
      element("groups").replaceChildren();
      listKeys();
      listErrors();
    }
    refuse(null);
    ranges.clear();
    updateKeys();
  }

  function options(select, choices) {
    select.replaceChildren(...choices.map(([key, text]) => create("option", { value: key, textContent: text })));
  }

  const isSet = (key) => Object.hasOwn(state.keys, key);
  const valueOf = (key) => isSet(key) ? state.keys[key] : values[key];

  // a value as text; one that follows from others has fewer digits
  function inText(value, digits = SET_DIGITS) {
    if (value === undefined || value === null) return "";
    if (Array.isArray(value)) return value.map((each) => Array.isArray(each) ? `[${inText(each, digits)}]` : typeof each === "string" ? JSON.stringify(each) : inText(each, digits)).join(", ");
    return typeof value === "number" ? String(Math.abs(value) < 1e-12 ? 0 : Number(value.toPrecision(digits))) : String(value);
  }

  const keyText = (key, keys, known) => Object.hasOwn(keys, key) ? inText(keys[key]) : inText(known[key], DERIVED_DIGITS);

  // the value that a text stands for: a number, a list, or the text itself, as a length with its unit
  function fromText(row, text) {
    const plain = text.trim();
    if (plain === "") return undefined;
    if (row.list) {
      try {
        return JSON.parse(`[${plain}]`);
      } catch {
        return plain.split(",").map((part) => Number.isFinite(Number(part)) ? Number(part) : part.trim());
      }
    }
    if (row.input !== "number") return plain;
    const number = Number(plain.replace("−", "-"));
    return Number.isFinite(number) ? number : plain;
  }

  function listKeys() {
    const words = element("search").value.trim().toLowerCase().split(/\s+/).filter(Boolean), every = element("every").checked;
    const groups = new Map();
    for (const row of rows) {
      if (errorKeys.includes(row.key)) continue;
      const found = words.every((word) => row.key.toLowerCase().includes(word) || row.about.toLowerCase().includes(word));
      if (!(words.length ? found : every || row.usual || isSet(row.key))) continue;
      const table = row.key.includes(".") ? row.key.slice(0, row.key.lastIndexOf(".")) : "";
      groups.set(table, [...(groups.get(table) ?? []), row]);
    }
    shownRows = new Map();
    const open = new Set([...document.querySelectorAll("#groups details[open]")].map((each) => each.dataset.table));
    const first = !document.querySelector("#groups details");
    element("groups").replaceChildren(...[...groups].map(([table, inside]) => {
      const details = create("details"), summary = create("summary");
      details.dataset.table = table;
      summary.textContent = table || "general";
      details.open = words.length > 0 || (first ? !table.includes(".") && groups.size < 12 || inside.some((row) => isSet(row.key)) : open.has(table));
      details.append(summary, ...inside.map(rowOf));
      return details;
    }));
    if (!groups.size) element("groups").textContent = "No key has these words.";
  }

  function rowOf(row) {
    const item = create("div"), name = row.key.slice(row.key.lastIndexOf(".") + 1), id = `key-${row.key}`;
    item.className = "key";
    item.dataset.key = row.key;
    const label = create("label", { htmlFor: id, textContent: name.replaceAll("_", " "), title: row.about });
    let input;
    if (row.input === "choice" || row.input === "flag") {
      input = create("select");
      options(input, (row.input === "flag" ? ["true", "false"] : row.choices).map((each) => [each, each.replaceAll("_", " ")]));
      input.addEventListener("change", () => set(row.key, row.input === "flag" ? input.value === "true" : input.value));
    } else {
      input = create("input", { type: "text", spellcheck: false });
      if (row.input === "number") input.inputMode = "decimal";
      input.addEventListener("change", () => set(row.key, fromText(row, input.value)));
    }
    input.id = id;
    const unit = create("span", { className: "unit", textContent: row.unit === "-" ? "" : row.unit });
    const back = create("button", { type: "button", className: "back", textContent: "↺", title: `Default: ${row.default}` });
    back.setAttribute("aria-label", `Back to the default of ${row.key}`);
    back.addEventListener("click", () => set(row.key, undefined));
    item.append(label, input, unit, back);
    item.addEventListener("focusin", () => choose(row, item));
    shownRows.set(row.key, { row, item, input, back });
    return item;
  }

  function updateKeys() {
    // a key that was set elsewhere gets its row
    if (Object.keys(state.keys).some((key) => !shownRows.has(key) && !errorKeys.includes(key) && rows.some((row) => row.key === key)) && !element("search").value) listKeys();
    for (const { row, item, input, back } of shownRows.values()) {
      const given = isSet(row.key);
      item.classList.toggle("free", !given);
      back.style.visibility = given && row.default !== "required" ? "visible" : "hidden";
      if (document.activeElement !== input || input.tagName === "SELECT") input.value = keyText(row.key, state.keys, values);
      else if (given) input.value = inText(state.keys[row.key]);
      const inWords = !given && input.tagName === "INPUT" && values[row.key] === undefined;
      if (inWords) input.placeholder = row.default;
      // the title has what the field may have no room for
      if (input.tagName === "SELECT") input.title = input.selectedOptions[0]?.textContent ?? "";
      else input.title = inWords ? row.default : given ? input.value : inText(values[row.key], 17);
      const slider = item.querySelector("input[type=range]");
      if (slider && document.activeElement !== slider && typeof valueOf(row.key) === "number") slider.value = valueOf(row.key);
    }
    updateErrors();
  }

  // the row in use shows its meaning, what is allowed, and a slider over what builds
  function choose(row, item) {
    if (chosen?.row.key === row.key && item.querySelector(".more")) return;
    chosen?.item.querySelectorAll(".more, input[type=range]").forEach((each) => each.remove());
    chosen = { row, item };
    const more = create("div");
    more.className = "more";
    more.textContent = `${row.about}${row.source ? ` [${row.source.replace(/^\[|\]$/g, "")}]` : ""}. Allowed: ${row.allowed}. Default: ${row.default}.`;
    item.append(more);
    askRange();
  }

  function askRange() {
    const row = chosen?.row;
    if (!row || row.input !== "number" || busy || typeof valueOf(row.key) !== "number") return;
    if (ranges.has(row.key)) showRange(row.key);
    else if (rangeAsked !== `${latest}/${row.key}`) {
      rangeAsked = `${latest}/${row.key}`;
      ask("range", { from: state.from, keys: state.keys, key: row.key });
    }
  }

  // 1, 2 or 5 times a power of ten
  function even(size) {
    const power = 10 ** Math.floor(Math.log10(size)), first = size / power;
    return (first < 1.5 ? 1 : first < 3.5 ? 2 : first < 7.5 ? 5 : 10) * power;
  }

  const snapped = (value, by) => Number((Math.round(value / by) * by).toPrecision(10));

  function slider(key, low, high, by, label) {
    const made = create("input", { type: "range", min: low, max: high, step: by });
    made.setAttribute("aria-label", label);
    made.value = valueOf(key) ?? 0;
    const moved = (live) => set(key, Math.min(Math.max(snapped(Number(made.value), by), low), high), live);
    made.addEventListener("input", () => moved(true));
    made.addEventListener("change", () => { moved(true); merging = null; });
    return made;
  }

  function takeRange(message) {
    ranges.set(message.key, message);
    showRange(message.key);
  }

  function showRange(key) {
    if (chosen?.row.key !== key) return;
    const { row, item } = chosen, found = ranges.get(key), before = item.querySelector("input[type=range]");
    if (before && (document.activeElement === before || Number(before.min) === found.low)) return;
    before?.remove();
    if (!(found.high > found.low)) return;
    const by = row.whole ? 1 : even((found.high - found.low) / 200);
    const low = row.whole ? found.low : Math.ceil(found.low / by - 1e-9) * by, high = row.whole ? found.high : Math.floor(found.high / by + 1e-9) * by;
    const made = slider(key, low, high, by, `${key}, from ${inText(low)} to ${inText(high)}`);
    item.append(made);
    const more = item.querySelector(".more");
    const words = (value, known) => `${inText(Number(value.toPrecision(5)))}${known ? "" : " or beyond"}`;
    if (more) more.textContent = `${more.textContent.replace(/ Builds from .*$/, "")} Builds from ${words(found.low, found.low_known)} to ${words(found.high, found.high_known)}.`;
  }

  // ---------------------------------------------------------------- refusals

  function takeRefusal(message) {
    const about = asked.get(message.id)?.what;
    // of a question that is stale, or of a range that the page can do without
    if (about === undefined || about === "range") return;
    if (about !== "show") {
      trouble(message.line);
      lasting = false;
      return;
    }
    if (message.id !== latest) return;
    grey(true);
    refuse(message);
  }

  // the last good gears stay, greyed
  function grey(old) {
    for (const id of ["view", "results"]) element(id).classList.toggle("old", old);
  }

  function refuse(message) {
    const inUse = document.activeElement?.closest(".refusal");
    document.querySelectorAll(".key .refusal, .error .refusal").forEach((each) => each.remove());
    const general = element("refusal");
    general.hidden = true;
    general.replaceChildren();
    if (!message) return;
    const row = shownRows.get(message.key) ?? errorRows.get(message.key);
    const target = row ? create("div", { className: "refusal" }) : general;
    target.append(message.line);
    for (const offer of message.offers) {
      const button = create("button", { type: "button", textContent: offer.text });
      button.addEventListener("click", () => set(offer.key, offer.value));
      target.append(create("br"), button);
    }
    if (past[place - 1]) {
      const back = create("button", { type: "button", className: "take-back", textContent: "undo" });
      back.addEventListener("click", () => step(-1));
      if (!message.offers.length) target.append(create("br"));
      target.append(back);
    }
    target.hidden = false;
    if (row) {
      target.setAttribute("role", "alert");
      row.item.append(target);
      const details = row.item.closest("details");
      if (details) details.open = true;
    }
    target.scrollIntoView({ block: "nearest" });
    // the buttons are made anew when their offers have been tried
    if (inUse) target.querySelector("button")?.focus({ preventScroll: true });
  }

  // ---------------------------------------------------------------- figures

  let figures = [], pinned = null;

  function amount(value, signed = false) {
    if (value === null || value === undefined) return "not known";
    const size = Math.abs(value), whole = size >= 1000 ? size.toFixed(0) : String(Number(size.toPrecision(DIGITS)));
    const sign = value < 0 && Number(whole) ? "−" : signed && Number(whole) ? "+" : "";
    return sign + whole;
  }
  // a change without what is rounding beside the values
  const changeOf = (before, now) => amount(Number(((now - before) / Math.max(Math.abs(before), Math.abs(now), 1e-12)).toFixed(CHANGE_DIGITS)) && now - before, true);
  const unitOf = (unit) => UNITS[unit] ?? unit;

  // figures that come later keep their earlier values until then, greyed
  function takeFigures(message) {
    element("pin").disabled = message.later;
    if (message.later) {
      element("results").classList.remove("old");
      figures = withEarlier(message.meshes);
      drawFigures();
      return;
    }
    grey(false);
    figures = message.meshes;
    drawFigures();
    const box = create("div");
    if (message.warnings.length) {
      box.className = "warnings";
      const list = create("ul");
      list.append(...message.warnings.map((line) => create("li", { textContent: line })));
      box.append(create("h2", { textContent: "Warnings" }), list);
    } else {
      box.className = "good";
      box.textContent = "No warnings.";
    }
    element("warnings-here").replaceChildren(box);
    drawCompare();
  }

  function withEarlier(meshes) {
    const earlier = figures.map((mesh) => ({ ...mesh, figures: mesh.figures.map((figure) => ({ ...figure, old: true })) }));
    const named = new Map([...earlier, ...meshes].map((mesh) => [mesh.name, mesh]));
    return [...named.keys()].map((name) => {
      const before = earlier.find((mesh) => mesh.name === name)?.figures ?? [], now = meshes.find((mesh) => mesh.name === name)?.figures ?? [];
      const known = new Map([...before, ...now].map((figure) => [figure.key, figure]));
      return { name, figures: [...known.values()] };
    });
  }

  const capital = (text) => `${text[0].toUpperCase()}${text.slice(1)}`;

  function nameOf(figure) {
    const member = memberWords.find((name) => figure.key.includes(`_${name}_`));
    const words = figure.about.split(/[:;]/)[0];
    return member ? `${capital(member.replaceAll("_", " "))}: ${words}` : capital(words);
  }

  function figureOf(mesh, figure) {
    const item = create("div"), term = create("dt"), said = create("dd");
    item.className = figure.old ? "figure old" : "figure";
    item.dataset.figure = figure.key;
    term.textContent = nameOf(figure);
    term.title = figure.about;
    const strong = create("strong");
    strong.textContent = figure.value === null ? "not known" : `${amount(figure.value)} ${unitOf(figure.unit)}`.trim();
    said.append(strong);
    const before = pinned?.figures.find((each) => each.name === mesh.name)?.figures.find((each) => each.key === figure.key);
    if (before && before.value !== null && figure.value !== null) {
      const change = create("span");
      change.className = "change";
      const by = changeOf(before.value, figure.value);
      change.textContent = by === "0" ? "as pinned" : `${by} ${unitOf(figure.unit)}`.trim();
      said.append(change);
    }
    item.append(term, said);
    return item;
  }

  function drawFigures() {
    const open = new Set([...document.querySelectorAll("#figures details[open]")].map((each) => each.dataset.mesh));
    element("figures").replaceChildren(...figures.flatMap((mesh) => {
      const main = create("dl"), more = create("dl"), rest = create("details");
      main.append(...mesh.figures.filter((each) => each.main).map((each) => figureOf(mesh, each)));
      more.append(...mesh.figures.filter((each) => !each.main).map((each) => figureOf(mesh, each)));
      rest.dataset.mesh = mesh.name;
      rest.open = open.has(mesh.name);
      rest.append(create("summary", { textContent: "More figures" }), more);
      const head = figures.length > 1 ? [create("h3", { textContent: mesh.name })] : [];
      return [...head, main, ...(more.children.length ? [rest] : [])];
    }));
    if (!figures.length) element("figures").textContent = "A gear without a mating gear has no contact.";
  }

  // ---------------------------------------------------------------- errors of assembly

  let errorRows = new Map();

  function listErrors() {
    element("errors").hidden = !errorKeys.length;
    errorRows = new Map();
    const size = typeof values.module === "number" ? values.module : typeof values.diametral_pitch === "number" ? 1 / values.diametral_pitch : 1;
    element("error-rows").replaceChildren(...errorKeys.map((key) => {
      const row = rows.find((each) => each.key === key), item = create("div");
      item.className = "error";
      item.dataset.key = key;
      const id = `error-${key}`;
      const label = create("label", { htmlFor: id, textContent: key.split(".")[1].replaceAll("_", " "), title: row.about });
      const input = create("input", { type: "text", id, inputMode: "decimal" });
      const unit = create("span", { className: "unit", textContent: row.unit });
      const back = create("button", { type: "button", className: "back", textContent: "0" });
      back.setAttribute("aria-label", `${key} back to its default`);
      const reach = row.length ? even(size / 10) : 0.5;
      const range = slider(key, -reach, reach, even(reach / 100), `${row.about}, ${row.unit}`);
      input.addEventListener("change", () => set(key, fromText(row, input.value)));
      back.addEventListener("click", () => set(key, undefined));
      const about = create("small", { className: "hint", textContent: row.about });
      about.style.gridColumn = "1 / -1";
      item.append(label, input, unit, back, range, about);
      errorRows.set(key, { item, input, range, back });
      return item;
    }));
    updateErrors();
  }

  function updateErrors() {
    for (const [key, { input, range, back }] of errorRows) {
      const value = valueOf(key) ?? 0;
      if (document.activeElement !== input) input.value = inText(value);
      if (document.activeElement !== range && typeof value === "number") range.value = value;
      back.style.visibility = isSet(key) ? "visible" : "hidden";
    }
  }

  // ---------------------------------------------------------------- scene and curves

  let held = [], shown = null, scene = null, share = 0.5;
  const curves = window.gearmeshCurves(element("curves"), (to) => {
    if (!scene) {
      share = to;
      curves.follow(to);
      return;
    }
    element("roll").value = to;
    element("roll").dispatchEvent(new Event("input"));
  });
  try {
    scene = window.gearmeshScene();
  } catch {
    scene = null;
  }
  element("no-view").hidden = Boolean(scene);
  scene?.listen(({ pair, x }) => {
    share = x;
    if (pair !== drawn) drawCurves(pair);
    curves.follow(x);
  });
  let drawn = null;

  function drawCurves(name) {
    drawn = name;
    const pair = shown?.pairs.find((each) => each.name === name) ?? shown?.pairs[0];
    curves.show(pair, shown?.members ?? [], pinned?.pairs?.find((each) => each.name === pair?.name));
    curves.follow(share);
  }

  // curves do not wait for the meshes of the view
  function takeCurves(message) {
    shown = { ...shown, ...message };
    drawn = null;
    drawCurves(scene?.state.pair ?? message.pairs[0]?.name);
  }

  function takeScene(message) {
    element("view").classList.remove("old");
    shown = message.pairs ? message : { ...shown, shapes: message.shapes, members: message.members };
    drawn = null;
    if (scene) {
      held = message.shapes.map((shape) => shape.key);
      scene.show(shown, anew);
      anew = false;
    }
    if (drawn === null) drawCurves(scene?.state.pair ?? shown.pairs[0]?.name);
    const present = element("compared").querySelector("img.present");
    if (present) present.src = scene.picture();
  }

  // ---------------------------------------------------------------- pinned state

  function pin() {
    pinned = { state, figures, pairs: shown?.pairs, values, picture: scene && shown ? scene.picture() : null };
    element("unpin").hidden = false;
    drawFigures();
    drawCurves(drawn);
    drawCompare();
  }

  function unpin() {
    pinned = null;
    element("unpin").hidden = true;
    element("compare").hidden = true;
  }

  function table(title, heads, lines) {
    const scroll = create("div"), made = create("table");
    scroll.className = "scroll";
    made.append(create("caption", { textContent: title }));
    for (const [k, line] of [heads, ...lines].entries()) {
      const row = create("tr");
      row.append(...line.map((text) => create(k ? "td" : "th", { textContent: text })));
      made.append(row);
    }
    scroll.append(made);
    return scroll;
  }

  function drawCompare() {
    element("compare").hidden = !pinned;
    if (!pinned) return;
    const every = new Set([...Object.keys(pinned.values), ...Object.keys(values), ...Object.keys(state.keys), ...Object.keys(pinned.state.keys)]);
    const before = (key) => keyText(key, pinned.state.keys, pinned.values), now = (key) => keyText(key, state.keys, values);
    const other = [...every].filter((key) => before(key) !== now(key));
    const parts = [table(other.length ? "Keys that differ" : "No key differs", ["key", "pinned", "present"], other.map((key) => [key, before(key), now(key)]))];
    for (const mesh of figures) {
      const pinnedMesh = pinned.figures.find((each) => each.name === mesh.name);
      const lines = mesh.figures.filter((each) => each.main).map((each) => {
        const then = pinnedMesh?.figures.find((figure) => figure.key === each.key)?.value ?? null;
        const change = then === null || each.value === null ? "" : changeOf(then, each.value);
        return [nameOf(each), amount(then), amount(each.value), change, unitOf(each.unit)];
      });
      parts.push(table(`Figures of ${mesh.name}`, ["figure", "pinned", "present", "change", "unit"], lines));
    }
    if (pinned.picture) {
      const pictures = create("div");
      pictures.className = "pictures";
      for (const [caption, source] of [["pinned", pinned.picture], ["present", scene.picture()]]) {
        const figure = create("figure");
        figure.append(create("img", { src: source, className: caption, alt: `The view, ${caption}` }),
          create("figcaption", { textContent: caption }));
        pictures.append(figure);
      }
      parts.push(pictures);
    }
    element("compared").replaceChildren(...parts);
  }

  // ---------------------------------------------------------------- files

  function save(name, content, type = "application/octet-stream") {
    const address = URL.createObjectURL(new Blob([content], { type }));
    create("a", { href: address, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }

  element("save").addEventListener("change", () => {
    const what = element("save").value, member = element("saved-member").value;
    element("save").value = "";
    if (!state || !what) return;
    if (what === "picture") {
      if (!scene || !shown) {
        trouble("Without WebGL there is no picture.");
        lasting = false;
      }
      else save("view.png", bytes(scene.picture().split(",")[1]), "image/png");
      return;
    }
    trouble("");
    filing = ask("file", { from: state.from, keys: state.keys, suffix: what, member });
    element("status").textContent = "Writing the file";
  });

  // ---------------------------------------------------------------- kinds and samples

  function showStart(message) {
    starting(true);
    const card = (name, about, from, picture) => {
      const item = create("li"), button = create("button", { type: "button" });
      if (picture) {
        const image = create("img", { src: picture, alt: "", width: 320, height: 240 });
        image.addEventListener("error", () => image.remove());
        button.append(image);
      }
      button.append(create("strong", { textContent: name }), create("small", { textContent: about }));
      button.addEventListener("click", () => ask("open", { from }));
      item.append(button);
      return item;
    };
    element("kinds").replaceChildren(...message.kinds.map((kind) => card(kind.name.replaceAll("_", " "), kind.about, `kind:${kind.name}`, `/kinds/${kind.name}.jpg`)));
    element("samples").replaceChildren(...message.samples.map((sample) => card(sample.name.replaceAll("_", " "), sample.about, `sample:${sample.name}`)));
  }

  // ---------------------------------------------------------------- controls

  element("undo").addEventListener("click", () => step(-1));
  element("redo").addEventListener("click", () => step(1));
  element("pin").addEventListener("click", pin);
  element("unpin").addEventListener("click", () => {
    unpin();
    drawFigures();
    drawCurves(drawn);
  });
  element("other").addEventListener("click", () => element("start").hidden ? ask("start") : starting(false));
  element("search").addEventListener("input", () => { listKeys(); updateKeys(); });
  element("every").addEventListener("change", () => { listKeys(); updateKeys(); });
  element("groups").addEventListener("submit", (event) => event.preventDefault());
  addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || !["z", "y"].includes(event.key.toLowerCase())) return;
    if (event.target.matches("input[type=text], input[type=search]")) return;
    step(event.key.toLowerCase() === "y" || event.shiftKey ? 1 : -1);
    event.preventDefault();
  });
  addEventListener("hashchange", () => {
    const linked = decode(location.hash.slice(1));
    if (linked && entered) replace(linked, null);
  });
  connect();

  window.gearmeshExplore = {
    get state() {
      return { state, busy: Boolean(busy), entered, figures, values, errors: errorKeys, latest, history: past.length, scene: scene?.state ?? null, held, ranges: Object.fromEntries(ranges) };
    },
    listen: (listener) => { heard = listener; },
  };
})();
