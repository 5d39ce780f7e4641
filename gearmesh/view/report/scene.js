// A scene in a page: gears that roll with their contact. Data: see stage.py; elements of the page: see viewer.html. Frames: every
// member has a group whose matrix takes its own frame to the fixed one; contact marks stand in the fixed frame, ellipses and colours
// on the flanks. `show` may be called again with other gears: camera, choices and position stay, and geometry with a known key too.
window.gearmeshScene = function () {
  "use strict";

  const element = (id) => document.getElementById(id);

  // asked for before a renderer is made, which would complain aloud
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) return null;
  context.getExtension("WEBGL_lose_context")?.loseContext();

  // a loop takes a fifth of the time of Uint8Array.from with a function
  function bytes(text) {
    const plain = atob(text), array = new Uint8Array(plain.length);
    for (let k = 0; k < plain.length; k++) array[k] = plain.charCodeAt(k);
    return array.buffer;
  }
  const floats = (text) => new Float32Array(bytes(text));
  const vector = (v) => new THREE.Vector3(v[0], v[1], v[2]);

  // viridis from large to small amounts, as in the pictures: apart for all kinds of colour vision, and in grey
  const COLOURS = ["#fde725", "#addc30", "#5ec962", "#28ae80", "#21918c", "#2c728e", "#3b528b", "#472d7b", "#440154"];
  const COMPOUND = [0.247, 0.498, 0.769], ELLIPSE = [0.78, 0.06, 0.18], CAP = "vec3(0.62, 0.36, 0.28)";
  const FIELD_OF_VIEW = 20, SECONDS = 5, CLICK = 5, CONTACT = "contact";
  // cosine of the angle up to which directions from root to tip look alike
  const ALIKE = 0.85;

  // ---------------------------------------------------------------- members

  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 1, 1000);
  scene.add(camera, new THREE.AmbientLight(0xffffff, 1.1));
  for (const [x, y, z, strength] of [[-0.6, 0.9, 1, 1.3], [1, 0.1, 0.3, 1.0], [-1, 0, 0.3, 0.6], [0, -1, 0.4, 0.5]]) {
    const light = new THREE.DirectionalLight(0xffffff, strength);
    light.position.set(x, y, z);
    light.target.position.set(0, 0, 0);
    camera.add(light, light.target);
  }

  function geometry(mesh, colours) {
    const shades = new Uint8Array(bytes(mesh.shades)), painted = new Float32Array(3 * shades.length);
    const paints = colours.map((colour) => new THREE.Color(colour));
    shades.forEach((shade, k) => paints[shade].toArray(painted, 3 * k));
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(floats(mesh.positions), 3));
    made.setAttribute("normal", new THREE.BufferAttribute(new Int8Array(bytes(mesh.normals)), 3, true));
    made.setAttribute("color", new THREE.BufferAttribute(painted, 3));
    const corners = bytes(mesh.corners);
    made.setIndex(new THREE.BufferAttribute(mesh.wide ? new Uint32Array(corners) : new Uint16Array(corners), 1));
    const edges = new THREE.BufferGeometry(), ends = bytes(mesh.edges);
    edges.setAttribute("position", made.getAttribute("position"));
    edges.setIndex(new THREE.BufferAttribute(mesh.wide ? new Uint32Array(ends) : new Uint16Array(ends), 1));
    return { faces: made, edges };
  }

  function steel() {
    const material = new THREE.MeshPhongMaterial({ vertexColors: true, shininess: 25, specular: 0x222222,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    // what is seen from inside is the section of a solid
    material.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace("#include <dithering_fragment>",
        `#include <dithering_fragment>\nif (!gl_FrontFacing) gl_FragColor = vec4(${CAP}, gl_FragColor.a);`);
    };
    return material;
  }

  // what an angle does to a member in its own frame: a turn about z, or a slide
  function motion(member, angle) {
    const by = new THREE.Matrix4();
    return member.travel ? by.makeTranslation(0, member.travel * angle, 0) : by.makeRotationZ(angle);
  }

  let data = null, members = [], pairs = [], geometries = new Map();

  function discard(part) {
    for (const { faces, edges } of [part.tooth, part.rest]) {
      faces.dispose();
      edges.dispose();
    }
  }

  // geometry of all shapes; shapes with a key come without meshes where they were shown before
  function takeShapes() {
    const taken = new Map();
    data.shapes.forEach((shape, k) => {
      const { colours } = data.members.find((member) => member.shape === k);
      const key = shape.key ?? k, known = shape.key === undefined ? undefined : geometries.get(key);
      taken.set(key, known ?? { tooth: geometry(shape.tooth, colours), rest: geometry(shape.rest, colours) });
    });
    geometries.forEach((part, key) => { if (taken.get(key) !== part) discard(part); });
    geometries = taken;
  }

  function memberOf(member) {
    const { key } = data.shapes[member.shape], group = new THREE.Group(), material = steel();
    group.matrixAutoUpdate = false;
    const { tooth, rest: under } = geometries.get(key ?? member.shape), ink = new THREE.LineBasicMaterial({ color: 0x46525e });
    const [teeth, lines] = [[tooth.faces, material], [tooth.edges, ink]].map((parts) => new THREE.InstancedMesh(...parts, member.places.length));
    // the renderer draws an instanced mesh as lines if told so
    Object.assign(lines, { isMesh: false, isLine: true, isLineSegments: true });
    member.places.forEach((place, k) => {
      const moved = motion(member, place * member.pitch);
      teeth.setMatrixAt(k, moved);
      lines.setMatrixAt(k, moved);
    });
    const rest = new THREE.Mesh(under.faces, material);
    group.add(teeth, lines, rest, new THREE.LineSegments(under.edges, ink));
    scene.add(group);
    const base = placed(member), carrier = member.carrier && placed(member.carrier);
    const offset = new THREE.Matrix4().makeTranslation(member.eccentricity[0], member.eccentricity[1], 0);
    return { ...member, group, material, ink, instanced: [teeth, lines], solids: [teeth, rest], base, carrier, offset, mode: "solid" };
  }

  function placed({ rotation: r, translation: t }) {
    return new THREE.Matrix4().set(...r[0], t[0], ...r[1], t[1], ...r[2], t[2], 0, 0, 0, 1);
  }

  // `around`: rotation of the carrier of a member that has one
  function turned(member, phi, around = 0) {
    if (member.carrier) member.group.matrix.copy(member.carrier).multiply(new THREE.Matrix4().makeRotationZ(around)).multiply(member.base);
    else member.group.matrix.copy(member.base);
    member.group.matrix.multiply(motion(member, member.sign * (phi - member.zero))).multiply(member.offset);
    member.group.matrixWorldNeedsUpdate = true;
  }

  // ---------------------------------------------------------------- flanks

  const strip = new Uint8Array(COLOURS.flatMap((c) => [1, 3, 5].map((k) => parseInt(c.slice(k, k + 2), 16)).concat(255)));
  const ramp = new THREE.DataTexture(strip, COLOURS.length, 1);
  ramp.magFilter = ramp.minFilter = THREE.LinearFilter;
  ramp.needsUpdate = true;

  const VERTEX = `
    attribute float amount;
    varying vec3 place;
    varying float value;
    #include <clipping_planes_pars_vertex>
    void main() {
      place = position;
      value = amount;
      vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
      gl_Position = projectionMatrix * mvPosition;
      #include <clipping_planes_vertex>
    }`;
  const FRAGMENT = `
    uniform int kind;
    uniform float limit;
    uniform sampler2D ramp;
    uniform bool touching;
    uniform vec3 centre, major, minor, compound, ellipse;
    varying vec3 place;
    varying float value;
    #include <clipping_planes_pars_fragment>
    void main() {
      #include <clipping_planes_fragment>
      vec4 colour = vec4(0.0);
      if (value >= 0.0 && kind == 1 && value <= 1.0) colour = vec4(compound, 1.0);
      if (value >= 0.0 && kind == 2 && value <= limit) colour = vec4(texture2D(ramp, vec2(0.94 * value / limit + 0.03, 0.5)).rgb, 1.0);
      vec3 away = place - centre;
      float within = length(vec2(dot(away, major), dot(away, minor)));
      if (touching && within <= 1.0) colour = vec4(within > 1.0 - 2.0 * fwidth(within) ? vec3(1.0) : ellipse, 1.0);
      if (colour.a == 0.0) discard;
      gl_FragColor = colour;
    }`;

  function flankOf(flank) {
    const [rows, columns] = flank.shape, made = new THREE.BufferGeometry(), points = floats(flank.points), corners = [];
    const known = (k) => Number.isFinite(points[3 * k]);
    for (let i = 0; i + 1 < rows; i++) {
      for (let j = 0; j + 1 < columns; j++) {
        const a = i * columns + j, cell = [a, a + 1, a + columns + 1, a + columns];
        if (cell.every(known)) corners.push(cell[0], cell[1], cell[2], cell[0], cell[2], cell[3]);
      }
    }
    made.setAttribute("position", new THREE.BufferAttribute(points, 3));
    made.setAttribute("amount", new THREE.BufferAttribute(new Float32Array(rows * columns).fill(-1), 1));
    made.setIndex(corners);
    const uniforms = {
      kind: { value: 0 }, limit: { value: 1 }, ramp: { value: ramp }, touching: { value: false }, compound: { value: vector(COMPOUND) },
      ellipse: { value: vector(ELLIPSE) }, centre: { value: vector([0, 0, 0]) }, major: { value: vector([0, 0, 0]) },
      minor: { value: vector([0, 0, 0]) },
    };
    const material = new THREE.ShaderMaterial({ uniforms, vertexShader: VERTEX, fragmentShader: FRAGMENT, side: THREE.DoubleSide,
      clipping: true, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -4 });
    const mesh = new THREE.Mesh(made, material);
    mesh.renderOrder = 1;
    mesh.visible = false;
    const fields = flank.fields.map((field) => ({ ...field, values: floats(field.values), torques: field.torques?.map(floats) }));
    const tracks = Object.fromEntries(["contact", "normal", "major", "minor"].map((key) => [key, floats(flank[key])]));
    return { ...flank, ...tracks, fields, points, mesh, uniforms };
  }

  // values at a fractional position: linear, or those of the nearer one where the other has none
  function at(track, size, x) {
    const last = track.length / size - 1, low = Math.max(0, Math.min(Math.floor(x), last - 1)), part = last > 0 ? x - low : 0;
    return Array.from({ length: size }, (_, k) => {
      const a = track[low * size + k], b = last > 0 ? track[(low + 1) * size + k] : a;
      return Number.isNaN(a + b) ? (part < 0.5 ? a : b) : a + part * (b - a);
    });
  }

  // a place among the positions of a pair; between two of them from one to the other of which contact jumps, the nearer one
  const steady = (pair, x) => pair.jumps.includes(Math.floor(x)) ? Math.round(x) : x;

  function pairOf(pair) {
    const flanks = pair.flanks.map(flankOf);
    flanks.forEach((flank, k) => members[pair.members[k]].group.add(flank.mesh));
    const tracks = Object.fromEntries(["phi1", "te", "point", "normal", "lines"].map((key) => [key, floats(pair[key])]));
    const loads = (pair.loaded?.loads ?? []).map((load) => ({ ...load,
      te: floats(load.te), stress: floats(load.stress), halves: load.halves.map((half) => ({ ...half,
        ...Object.fromEntries(["phase", "share", "bands", "across"].map((key) => [key, floats(half[key])])) })) }));
    const loaded = pair.loaded && { ...pair.loaded, phi1: floats(pair.loaded.phi1), loads };
    const carried = (pair.carried ?? []).map((track) => track && floats(track));
    const shafts = (pair.shafts ?? []).map((shaft) => ({ ...shaft, turns: floats(shaft.turns) }));
    return { ...pair, ...tracks, turns: pair.turns.map(floats), carried, shafts, flanks, loaded };
  }

  // ---------------------------------------------------------------- contact marks, seen through the gears

  const seen = { color: 0xc8102e, depthTest: false, transparent: true };
  const dot = new THREE.Mesh(new THREE.SphereGeometry(1, 20, 14), new THREE.MeshBasicMaterial(seen));
  const ribbon = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({ ...seen, side: THREE.DoubleSide }));
  const action = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial(seen));
  ribbon.frustumCulled = action.frustumCulled = false;
  for (const mark of [dot, ribbon, action]) {
    mark.renderOrder = 10;
    scene.add(mark);
  }

  function drawRibbon(points, normal, width) {
    const count = points.length / 3, places = [], corners = [], out = vector(normal);
    const point = (k) => vector(points.slice(3 * k, 3 * k + 3));
    for (let k = 0; k < count; k++) {
      const along = point(Math.min(k + 1, count - 1)).sub(point(Math.max(k - 1, 0)));
      const across = along.cross(out).normalize().multiplyScalar(width);
      places.push(...point(k).add(across).toArray(), ...point(k).sub(across).toArray());
      if (k) corners.push(2 * k - 2, 2 * k - 1, 2 * k, 2 * k - 1, 2 * k + 1, 2 * k);
    }
    ribbon.geometry.dispose();
    ribbon.geometry = new THREE.BufferGeometry();
    ribbon.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
    ribbon.geometry.setIndex(corners);
  }

  // ---------------------------------------------------------------- pressure now: a band on every tooth pair that carries

  const NOW = "pressure_now";
  const pressure = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.ShaderMaterial({
    uniforms: { ramp: { value: ramp }, limit: { value: 1 }, lift: { value: 0 } }, side: THREE.DoubleSide, clipping: true,
    polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -8,
    vertexShader: `
    attribute vec2 band;
    uniform float lift;
    varying vec2 across;
    #include <clipping_planes_pars_vertex>
    void main() {
      across = band;
      vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
      mvPosition.xyz += lift * normalize(-mvPosition.xyz);
      gl_Position = projectionMatrix * mvPosition;
      #include <clipping_planes_vertex>
    }`,
    fragmentShader: `
    uniform float limit;
    uniform sampler2D ramp;
    varying vec2 across;
    #include <clipping_planes_pars_fragment>
    void main() {
      #include <clipping_planes_fragment>
      float amount = across.y * sqrt(max(1.0 - across.x * across.x, 0.0));
      if (amount <= 0.0) discard;
      gl_FragColor = vec4(texture2D(ramp, vec2(0.94 * min(amount / limit, 1.0) + 0.03, 0.5)).rgb, 1.0);
    }` }));
  pressure.renderOrder = 2;
  pressure.frustumCulled = pressure.visible = false;
  scene.add(pressure);

  // where between phases a rotation lies; the nearer one where these are not joined; nothing beyond them
  function between(half, phase) {
    const { phase: known } = half, last = known.length - 1;
    if (phase < known[0] - 1e-9 || phase > known[last] + 1e-9) return null;
    let low = 0;
    while (low + 1 < last && known[low + 1] <= phase) low++;
    if (!last) return 0;
    const x = low + (phase - known[low]) / (known[low + 1] - known[low]);
    return half.joined[low] ? x : Math.round(x);
  }

  function drawPressure(pair, load, phi1, size) {
    const places = [], bands = [], corners = [], { pitch } = pair.loaded;
    for (const half of load.halves) {
      const first = Math.ceil((phi1 - half.phase.at(-1)) / pitch), last = Math.floor((phi1 - half.phase[0]) / pitch);
      const length = half.bands.length / half.phase.length;
      for (let k = first; k <= last; k++) {
        const x = between(half, phi1 - k * pitch);
        if (x === null) continue;
        const band = at(half.bands, length, x), across = at(half.across, 3, x);
        if (Number.isNaN(band[0])) continue;
        for (let j = 0; j < length / 5; j++) {
          const [px, py, pz, width, peak] = band.slice(5 * j, 5 * j + 5), n = places.length / 3;
          for (const side of [-1, 1]) {
            places.push(px + side * width * across[0], py + side * width * across[1], pz + side * width * across[2]);
            bands.push(side, peak);
          }
          if (j) corners.push(n - 2, n - 1, n, n - 1, n + 1, n);
        }
      }
    }
    pressure.geometry.dispose();
    pressure.geometry = new THREE.BufferGeometry();
    pressure.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
    pressure.geometry.setAttribute("band", new THREE.BufferAttribute(new Float32Array(bands), 2));
    pressure.geometry.setIndex(corners);
    pressure.material.uniforms.limit.value = pair.loaded.limit;
    pressure.material.uniforms.lift.value = 0.002 * size;
  }

  // the value of a curve over a pitch, closed at its end
  function cyclic(pair, track, size, phi1) {
    const known = pair.loaded.phi1, last = known.length - 1, { pitch } = pair.loaded;
    if (!last) return at(track, size, 0);
    const turn = known[0] + ((phi1 - known[0]) % pitch + pitch) % pitch;
    let low = 0;
    while (low + 1 < last && known[low + 1] <= turn) low++;
    return at(track, size, Math.min(low + (turn - known[low]) / (known[low + 1] - known[low]), last));
  }

  // ---------------------------------------------------------------- what is shown

  const canvas = element("canvas"), roll = element("roll");
  element("viewer").hidden = false;
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
  renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
  const controls = new THREE.TrackballControls(camera, canvas);
  controls.staticMoving = true;
  controls.rotateSpeed = 2.5;
  controls.zoomSpeed = 1.5;
  let heard = () => {}, current, picked = -1, stale = true, rolling = false, clock = 0;
  controls.addEventListener("change", () => { stale = true; });

  // what rounds to zero has no sign
  const rounded = (value, digits) => (Number(value.toFixed(digits)) || 0).toFixed(digits).replace("-", "−");
  const degrees = (angle) => `${rounded(angle * 180 / Math.PI, 3)}°`;

  function showPosition() {
    clearTape();
    const x = Number(roll.value) * (current.phi1.length - 1), nearest = Math.round(x);
    const turns = current.turns.map((track) => at(track, 1, x)[0]);
    members.forEach((member, k) => turned(member, turns[k], current.carried[k] ? at(current.carried[k], 1, x)[0] : 0));
    const place = steady(current, x);
    const point = at(current.point, 3, place), normal = at(current.normal, 3, place), line = at(current.lines, current.lines.length / current.phi1.length, place);
    const size = Math.min(...current.flanks.map((flank) => flank.size), 2 * extent);
    dot.visible = !Number.isNaN(point[0]) && Number.isNaN(line[0]);
    if (dot.visible) dot.position.set(...point);
    dot.scale.setScalar(0.008 * size);
    ribbon.visible = !Number.isNaN(line[0]);
    if (ribbon.visible) drawRibbon(line, normal, 0.006 * size);
    for (const flank of current.flanks) {
      const major = at(flank.major, 3, place), { uniforms } = flank;
      uniforms.touching.value = !Number.isNaN(major[0]);
      uniforms.centre.value.set(...at(flank.contact, 3, place));
      uniforms.major.value.set(...major);
      uniforms.minor.value.set(...at(flank.minor, 3, place));
    }
    const now = element("field").value === NOW, load = current.loaded?.loads[Number(element("torque").value)];
    pressure.visible = now && Boolean(load);
    if (pressure.visible) {
      dot.visible = ribbon.visible = false;
      for (const { uniforms } of current.flanks) uniforms.touching.value = false;
      drawPressure(current, load, at(current.phi1, 1, x)[0], size);
    }
    const te = rounded(at(current.te, 1, x)[0], 3), words = [`φ₁ = ${degrees(at(current.phi1, 1, x)[0])}`];
    const moved = ({ name, travel }, angle) => `${name} ${travel ? `${rounded(angle * travel, 3)} mm` : degrees(angle)}`;
    current.members.forEach((m) => words.push(moved(members[m], turns[m])));
    current.shafts.forEach((shaft) => words.push(moved(shaft, at(shaft.turns, 1, x)[0])));
    words.push(`transmission error ${te} ${current.te_unit}`);
    if (current.kind[nearest]) words.push(current.kind[nearest].startsWith("edge") ? current.kind[nearest] : `${current.kind[nearest]} contact`);
    if (load) {
      const phi1 = at(current.phi1, 1, x)[0];
      const share = load.halves.reduce((sum, half) => {
        const place = between(half, phi1);
        return sum + (place === null ? 0 : at(half.share, 1, place)[0]);
      }, 0);
      const stress = cyclic(current, load.stress, 2, phi1), under = rounded(cyclic(current, load.te, 1, phi1)[0], 2);
      words.push(`at ${Number(load.torque.toPrecision(4))} Nm: transmission error ${under} ${current.te_unit}`, `load share ${(100 * share).toFixed(0)} %`,
        `root stress ${current.members.map((m, k) => `${members[m].name} ${stress[k].toFixed(0)}`).join(", ")} MPa`);
    }
    element("position").textContent = words.join(", ");
    roll.setAttribute("aria-valuetext", words[0]);
    heard({ pair: current.name, phi1: at(current.phi1, 1, x)[0], x: Number(roll.value) });
    stale = true;
  }

  function showColours() {
    const key = element("field").value;
    let shown = null;
    for (const flank of current.flanks) {
      const field = flank.fields.find((each) => each.key === (key === NOW ? "" : key));
      shown = shown ?? field;
      flank.uniforms.kind.value = field ? (key === "pattern" ? 1 : 2) : 0;
      if (!field) continue;
      flank.uniforms.limit.value = field.limit;
      const amounts = flank.mesh.geometry.getAttribute("amount");
      // what is unknown lies far below what is shown
      const values = field.torques?.[Number(element("torque").value)] ?? field.values;
      amounts.array.set(values.map((value) => (Number.isNaN(value) ? -1e6 : value)));
      amounts.needsUpdate = true;
    }
    if (key === NOW && current.loaded) shown = { label: "pressure now (MPa)", limit: current.loaded.limit, above: current.loaded.above };
    const scaled = shown && key !== "pattern";
    element("scale").hidden = !shown;
    element("scale-bar").hidden = element("scale-ends").hidden = !scaled;
    element("scale-bar").style.display = element("scale-ends").style.display = scaled ? "" : "none";
    if (shown) element("scale-label").textContent = scaled ? shown.label : `${shown.label} (compound ${current.delta_um.toPrecision(3)} µm)`;
    if (scaled) {
      element("scale-bar").style.background = `linear-gradient(to right, ${COLOURS.join(", ")})`;
      const limit = shown.limit >= 1000 ? shown.limit.toFixed(0) : shown.limit.toPrecision(3);
      // small areas have more than the scale
      element("scale-limit").textContent = shown.above ? `≥ ${limit}` : limit;
    }
    showPosition();
  }

  function options(select, choices, value) {
    select.replaceChildren(...choices.map(([key, text]) => Object.assign(document.createElement("option"), { value: key, textContent: text })));
    if (value !== undefined) select.value = value;
  }

  // `kept`: place on the slider, camera and choices stay; `looked`: only the latter
  function showPair(k, kept = false, looked = kept) {
    current = pairs[k];
    pairs.forEach((pair) => pair.flanks.forEach((flank) => { flank.mesh.visible = pair === current; }));
    const keys = new Map(current.flanks.flatMap((flank) => flank.fields).map((field) => [field.key, field.label]));
    if (current.loaded) keys.set(NOW, "pressure now (MPa)");
    // a scene with more fields follows: what is chosen stays so
    if (current.later) for (const { value, textContent } of element("field").options) if (value && !keys.has(value)) keys.set(value, textContent);
    const before = element("field").value, chosen = element("torque").value;
    options(element("field"), [["", "contact now"], ...keys], keys.has(before) ? before : keys.keys().next().value ?? "");
    const torques = (current.loaded?.loads ?? []).map((load, k) => [String(k), `${Number(load.torque.toPrecision(4))} Nm`]);
    options(element("torque"), torques, torques.some(([key]) => key === chosen) ? chosen : torques.at(-1)?.[0]);
    element("torque-label").hidden = !torques.length;
    element("torque-label").style.display = torques.length ? "" : "none";
    // a train of stages moves without marks of contact
    const marked = current.flanks.length > 0, colours = element("field").parentElement;
    colours.hidden = !marked;
    colours.style.display = marked ? "" : "none";
    options(element("look"), [...(marked ? [[CONTACT, "the contact"]] : []), ["", "the gears"], ...current.members.map((m, i) => [String(i), `tooth of ${members[m].name}`])]);
    // which points of contact lines a solver reports means nothing
    const stride = current.lines.length / current.phi1.length, steps = [];
    const alone = (k) => !Number.isNaN(current.point[3 * k]) && Number.isNaN(current.lines[k * stride]);
    for (let k = 0; k + 1 < current.phi1.length; k++) if (alone(k) && alone(k + 1) && !current.jumps.includes(k)) steps.push(k, k + 1);
    action.geometry.dispose();
    action.geometry = new THREE.BufferGeometry();
    action.geometry.setAttribute("position", new THREE.BufferAttribute(current.point, 3));
    action.geometry.setIndex(steps);
    action.visible = steps.length > 0;
    roll.disabled = element("play").disabled = current.phi1.length < 2;
    if (!kept) {
      roll.value = roll.disabled || !marked ? 0 : 0.5;
      if (looked) element("look").value = "";
      else lookAt("");
    }
    showColours();
    showPosition();
  }

  // a gear without a mating gear stands still and has no contact to choose from, nor have gears that are `waiting` for their contact
  const withMate = canvas.getAttribute("aria-label");
  function showAlone(alone, kept, waiting) {
    const labels = ["pair", "field", "torque", "look"].map((id) => element(id).parentElement);
    for (const part of [roll.parentElement, element("position"), ...labels]) {
      part.hidden = alone && !waiting;
      part.style.display = alone && !waiting ? "none" : "";
    }
    roll.disabled = element("play").disabled = alone;
    canvas.setAttribute("aria-label", alone && !waiting ? withMate.replace("Gears in mesh", "The gear") : withMate);
    if (!alone) return;
    current = undefined;
    element("scale").hidden = true;
    dot.visible = ribbon.visible = action.visible = pressure.visible = false;
    members.forEach((member) => turned(member, 0));
    if (!kept) lookAt("");
  }

  function setMode(member, mode) {
    member.mode = member.select.value = mode;
    member.group.visible = mode !== "hidden";
    member.material.transparent = mode === "see-through";
    member.material.opacity = mode === "see-through" ? 0.25 : 1;
    member.material.depthWrite = mode !== "see-through";
    member.material.needsUpdate = true;
    stale = true;
  }

  // ---------------------------------------------------------------- camera

  const range = new THREE.Vector3(), most = new THREE.Vector3();
  let extent = 1;

  function measure() {
    range.set(Infinity, Infinity, Infinity);
    most.copy(range).negate();
    for (const member of members) {
      // a carried member goes round the axis of its carrier
      const here = vector((member.carrier ? data.members[members.indexOf(member)].carrier : member).translation);
      const away = member.reach + (member.carrier ? vector(member.translation).length() : 0), reach = vector([away, away, away]);
      range.min(here.clone().sub(reach));
      most.max(here.clone().add(reach));
    }
    extent = most.distanceTo(range);
  }

  function aim(focus, back, up, height) {
    const aspect = canvas.clientWidth / Math.max(canvas.clientHeight, 1);
    const distance = height * retreat(aspect) / 2 / Math.tan(FIELD_OF_VIEW * Math.PI / 360);
    controls.target.copy(focus);
    camera.up.copy(up).normalize();
    camera.position.copy(back).setLength(distance).add(focus);
    camera.lookAt(focus);
    stale = true;
  }

  // what of a flank looks as it does where it touches at the position shown: all of it, or a part of a thread that winds round its
  // axis. Its middle, its directions along and from root to tip, its height and its size, fixed frame
  function inSight(flank, member, x) {
    const [rows, columns] = flank.shape, middle = columns >> 1;
    const own = (k) => vector(flank.points.slice(3 * k, 3 * k + 3)).applyMatrix4(member.group.matrix);
    const roots = [], tips = [], heights = [];
    for (let j = 0; j < columns; j++) {
      roots.push(own(j));
      tips.push(own((rows - 1) * columns + j));
      heights.push(tips[j].clone().sub(roots[j]));
    }
    const point = vector(at(flank.contact, 3, x)).applyMatrix4(member.group.matrix);
    const away = roots.map((root, j) => point.distanceTo(root) + point.distanceTo(tips[j]));
    const nearest = Math.max(away.indexOf(Math.min(...away)), 0);
    const alike = (j) => heights[j].dot(heights[nearest]) > ALIKE * heights[j].length() * heights[nearest].length();
    let first = nearest, last = nearest;
    while (first > 0 && alike(first - 1)) first--;
    while (last < columns - 1 && alike(last + 1)) last++;
    const whole = last - first === columns - 1, centre = whole ? middle : nearest;
    // lines of the grid run aslant over threads
    const below = roots.reduce((best, root) => root.distanceTo(tips[centre]) < best.distanceTo(tips[centre]) ? root : best);
    return {
      point,
      centre: own((rows >> 1) * columns + centre),
      along: roots[last].clone().sub(roots[first]).normalize(),
      up: tips[centre].clone().sub(below),
      size: whole ? flank.size : Math.max(tips[first].distanceTo(roots[last]), roots[first].distanceTo(tips[last])),
      normal: vector(at(flank.normal, 3, x)).transformDirection(member.group.matrix),
    };
  }

  // the pinion's flank where it touches, through the other gears, as large as the teeth in mesh
  function lookAtContact() {
    const member = members[current.members[0]];
    members.filter((other) => other !== member).forEach((other) => setMode(other, "see-through"));
    showPosition();
    const { point, along, up, size, normal } = inSight(current.flanks[0], member, steady(current, Number(roll.value) * (current.phi1.length - 1)));
    aim(point, normal.multiplyScalar(0.7).add(along.multiplyScalar(0.8)).add(up.clone().setLength(0.5)), up,
      Math.max(5 * up.length(), 1.2 * size));
  }

  function lookAt(which) {
    members.forEach((member) => setMode(member, "solid"));
    element("look").value = which;
    if (which === CONTACT) {
      lookAtContact();
      return;
    }
    if (which === "") {
      const { focus, back, up, height } = data.camera;
      aim(vector(focus), vector(back), vector(up), 0.9 * height);
      return;
    }
    const member = members[current.members[which]];
    members.filter((other) => other !== member).forEach((other) => setMode(other, "hidden"));
    showPosition();
    const { centre, up, size, normal } = inSight(current.flanks[which], member, steady(current, Number(roll.value) * (current.phi1.length - 1)));
    aim(centre, normal.add(up.clone().setLength(0.6)), up, 0.9 * size);
  }

  // how far a camera is away for a ratio of width to height, over its distance in a wide view
  const retreat = (aspect) => 1 / Math.min(1, aspect / 1.333);
  let sized = false;

  function resize() {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!width || !height) return;
    const before = retreat(camera.aspect);
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    // what was in sight stays in sight
    if (sized) camera.position.sub(controls.target).multiplyScalar(retreat(camera.aspect) / before).add(controls.target);
    sized = Boolean(data);
    controls.handleResize();
    stale = true;
  }

  // a canvas of another size is empty until it is drawn
  function resized() {
    resize();
    if (data) draw();
  }

  function draw() {
    const distance = camera.position.distanceTo(controls.target);
    camera.near = Math.max(distance - 2 * extent, distance / 100);
    camera.far = distance + 2 * extent;
    camera.updateProjectionMatrix();
    renderer.render(scene, camera);
    stale = false;
  }

  // where the slider goes on from a place: the whole gears look alike after every pitch, so that they seem to turn on and on; of
  // a tooth the whole engagement is shown
  function further(place) {
    if (!current.members.length) return place % 1;
    const { phi1 } = current, part = Math.abs(members[current.members[0]].pitch / (phi1[phi1.length - 1] - phi1[0]));
    if (element("look").value !== "" || !(part < 1)) return place % 1;
    return place > 0.5 * (1 + part) ? place - part * Math.ceil((place - 0.5 * (1 + part)) / part) : place;
  }

  let inView = true;
  new IntersectionObserver(([entry]) => { inView = entry.isIntersecting; }).observe(canvas);

  function frame(now) {
    requestAnimationFrame(frame);
    if (rolling && current && inView) {
      roll.value = further(Number(roll.value) + Math.min(now - clock, 100) / 1000 / (current.seconds ?? SECONDS));
      showPosition();
    }
    clock = now;
    controls.update();
    if (stale && data) draw();
  }

  // ---------------------------------------------------------------- picking and cutting

  function pick(index) {
    picked = index;
    members.forEach((member, k) => {
      member.material.emissive.set(k === index ? 0x4a3000 : 0x000000);
      member.button.setAttribute("aria-pressed", String(k === index));
    });
    stale = true;
  }

  const ray = new THREE.Raycaster(), plane = new THREE.Plane();

  function hitAt(x, y) {
    const box = canvas.getBoundingClientRect();
    scene.updateMatrixWorld();
    ray.setFromCamera(new THREE.Vector2((x - box.left) / box.width * 2 - 1, 1 - (y - box.top) / box.height * 2), camera);
    const shown = members.filter((member) => member.mode !== "hidden");
    return ray.intersectObjects(shown.flatMap((member) => member.solids), false)
      .find((each) => !renderer.clippingPlanes.length || plane.distanceToPoint(each.point) >= 0);
  }

  function memberAt(x, y) {
    const hit = hitAt(x, y);
    return hit ? members.findIndex((member) => member.solids.includes(hit.object)) : -1;
  }

  // distance between two points clicked with the Shift key; a third begins anew, and points of gears that move are gone
  const ends = [], tape = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial(seen));
  tape.renderOrder = 11;
  tape.frustumCulled = tape.visible = false;
  scene.add(tape);

  function clearTape() {
    if (!ends.length) return;
    ends.length = 0;
    tape.visible = false;
    element("distance").textContent = "";
    stale = true;
  }

  function mark(x, y) {
    const hit = hitAt(x, y);
    if (ends.length === 2) clearTape();
    if (!hit) return;
    ends.push(hit.point.clone());
    tape.visible = ends.length === 2;
    element("distance").textContent = "First point taken; Shift and click a second one.";
    if (!tape.visible) return;
    tape.geometry.dispose();
    tape.geometry = new THREE.BufferGeometry();
    tape.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(ends.flatMap((end) => end.toArray())), 3));
    element("distance").textContent = `Distance of the two points: ${ends[0].distanceTo(ends[1]).toPrecision(4)} mm`;
    stale = true;
  }

  function cut() {
    const chosen = element("cut").value, axis = Number(chosen), place = element("place"), whole = chosen === "";
    place.disabled = whole;
    if (!whole) {
      const low = range.getComponent(axis), high = most.getComponent(axis);
      plane.normal.set(0, 0, 0).setComponent(axis, -1);
      plane.constant = (low + high) / 2 + Number(place.value) * (high - low) / 2;
    }
    renderer.clippingPlanes = whole ? [] : [plane];
    for (const { material } of members) {
      material.side = whole ? THREE.FrontSide : THREE.DoubleSide;
      material.needsUpdate = true;
    }
    stale = true;
  }

  let pressed = null;
  canvas.addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
  canvas.addEventListener("pointerup", (event) => {
    if (pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < CLICK) {
      if (event.shiftKey) mark(event.clientX, event.clientY);
      else pick(memberAt(event.clientX, event.clientY));
    }
    pressed = null;
  });
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [0, 1, -1], ArrowRight: [0, 1, 1], ArrowUp: [1, 0, -1], ArrowDown: [1, 0, 1] }[event.key];
    const zoom = { "+": 0.85, "=": 0.85, "-": 1 / 0.85 }[event.key];
    const arm = camera.position.clone().sub(controls.target);
    if (turns) {
      const axis = vector([turns[0], turns[1], 0]).applyQuaternion(camera.quaternion);
      const by = new THREE.Quaternion().setFromAxisAngle(axis, 0.12 * turns[2]);
      camera.up.applyQuaternion(by);
      arm.applyQuaternion(by);
    } else if (zoom) arm.multiplyScalar(zoom);
    else if (event.key === "Home") lookAt(element("look").value);
    else return;
    if (event.key !== "Home") camera.position.copy(controls.target).add(arm);
    event.preventDefault();
    stale = true;
  });

  // ---------------------------------------------------------------- controls

  function listMembers() {
    element("members").replaceChildren();
    for (const [k, member] of members.entries()) {
      const item = document.createElement("li"), swatch = document.createElement("i");
      member.button = Object.assign(document.createElement("button"), { type: "button" });
      swatch.style.background = member.colours[0];
      member.button.append(swatch, `${member.name}, ${member.teeth} teeth`);
      member.button.addEventListener("click", () => pick(picked === k ? -1 : k));
      member.select = document.createElement("select");
      member.select.setAttribute("aria-label", `How ${member.name} is drawn`);
      options(member.select, ["solid", "see-through", "hidden"].map((mode) => [mode, mode]));
      member.select.addEventListener("change", () => setMode(member, member.select.value));
      item.append(member.button, member.select);
      element("members").append(item);
    }
  }

  element("pair").addEventListener("change", (event) => showPair(Number(event.target.value)));
  element("field").addEventListener("change", showColours);
  element("torque").addEventListener("change", showColours);
  element("look").addEventListener("change", (event) => lookAt(event.target.value));
  element("cut").addEventListener("change", cut);
  element("place").addEventListener("input", cut);
  roll.addEventListener("input", () => {
    setRolling(false);
    showPosition();
  });
  function setRolling(wanted) {
    rolling = wanted;
    element("play").setAttribute("aria-pressed", String(rolling));
    element("play").textContent = rolling ? "Stop" : "Roll";
    element("position").setAttribute("role", rolling ? "none" : "status");
  }
  element("play").addEventListener("click", () => setRolling(!rolling));
  addEventListener("beforeprint", () => {
    draw();
    element("print-view").src = canvas.toDataURL("image/png");
  });
  new ResizeObserver(resized).observe(canvas);

  // materials that were replaced last: a renderer compiles its programs anew once no material has them, so they stay until others do
  let replaced = [];

  function drop() {
    replaced.forEach((material) => material.dispose());
    replaced = [];
    for (const member of members) {
      scene.remove(member.group);
      member.instanced.forEach((part) => part.dispose());
      replaced.push(member.material, member.ink);
    }
    for (const { mesh } of pairs.flatMap((pair) => pair.flanks)) {
      mesh.geometry.dispose();
      replaced.push(mesh.material);
    }
  }

  // `anew`: other gears, which are looked at as at the first time
  function show(given, anew = false) {
    clearTape();
    const modes = new Map(members.map((member) => [member.name, member.mode])), look = element("look").value;
    const shown = current?.name, chosen = members[picked]?.name;
    drop();
    data = given;
    takeShapes();
    members = data.members.map(memberOf);
    pairs = data.pairs.map(pairOf);
    const kept = !anew && modes.size === members.length && members.every((member) => modes.has(member.name));
    measure();
    listMembers();
    pick(kept ? members.findIndex((member) => member.name === chosen) : -1);
    options(element("pair"), pairs.map((pair, k) => [String(k), pair.name]));
    resize();
    showAlone(!pairs.length, kept, Boolean(data.waiting));
    element("pair-label").hidden = pairs.length < 2;
    element("pair-label").style.display = pairs.length < 2 ? "none" : "";
    if (pairs.length) {
      const k = Math.max(pairs.findIndex((pair) => pair.name === shown), 0);
      element("pair").value = String(k);
      showPair(k, kept && shown !== undefined, kept);
    }
    if (kept) {
      // without contact there is no tooth to look at, and nothing that hides the mating member
      if (pairs.length || look === "" || data.waiting) members.forEach((member) => setMode(member, modes.get(member.name)));
      if (pairs.length && shown !== undefined) element("look").value = look;
    }
    cut();
  }

  requestAnimationFrame(frame);

  return {
    show,
    roll: setRolling,
    listen: (listener) => { heard = listener; },
    picture: () => {
      draw();
      return canvas.toDataURL("image/png");
    },
    get state() {
      return { phi1: current ? at(current.phi1, 1, Number(roll.value) * (current.phi1.length - 1))[0] : 0, pair: current?.name ?? null, picked: members[picked]?.name ?? null,
        matrices: members.map((member) => member.group.matrix.toArray()), triangles: renderer.info.render.triangles,
        camera: [...camera.position.toArray(), ...controls.target.toArray()] };
    },
    memberAt: (x, y) => members[memberAt(x, y)]?.name ?? null,
  };
};
