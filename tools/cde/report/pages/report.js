// SPDX-License-Identifier: Apache-2.0
// The 3-D view of a run. Without scripts or WebGL the still picture in the page stays.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const stage = document.getElementById("stage"), controls = document.getElementById("controls");
  if (!data.views.length) return;

  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const floats = (text) => new Float32Array(bytes(text));
  const vector = (v) => new THREE.Vector3(v[0], v[1], v[2]);

  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });  // kept for print
  } catch (error) {
    document.getElementById("readout").textContent = "WebGL is not available: the first frame, drawn by cde.";
    return;
  }
  const still = stage.querySelector("img");
  still.replaceWith(renderer.domElement);
  const canvas = renderer.domElement;
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", still.alt + " Arrow keys turn the view, plus and minus zoom.");
  controls.hidden = false;

  const scene = new THREE.Scene();
  scene.background = new THREE.Color("#10161d");
  const low = vector(data.box[0]), high = vector(data.box[1]), size = high.distanceTo(low);
  const camera = new THREE.PerspectiveCamera(data.camera.fov, 2, 1e-3 * size, 30 * size);
  camera.up.set(0, 0, 1);
  const sky = new THREE.HemisphereLight(0xdfe8f5, 0x4a505a, 0.55);
  scene.add(sky);
  const sun = new THREE.DirectionalLight(0xfff4e2, 0.75);
  sun.position.set(-0.55, 0.35, 0.62);
  scene.add(sun);
  const layers = { rays: new THREE.Group(), hits: new THREE.Group() };
  scene.add(layers.rays, layers.hits);

  // Makes the view of an object. update(state) shows its state in a frame.
  function surface(object) {
    const geometry = new THREE.BufferGeometry();
    const corners = bytes(object.corners);
    const index = object.corner_bits === 16 ? new Uint16Array(corners) : new Uint32Array(corners);
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    if (object.points) geometry.setAttribute("position", new THREE.BufferAttribute(floats(object.points), 3));
    // Flat shading needs no normals. The offset keeps hits in front of surfaces.
    const material = new THREE.MeshPhongMaterial({ color: object.colour, side: THREE.DoubleSide, flatShading: index.length < 30000,
      shininess: 0, specular: 0, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4 });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.frustumCulled = false;
    mesh.matrixAutoUpdate = false;
    if (object.points && !material.flatShading) geometry.computeVertexNormals();
    scene.add(mesh);
    let first = null;
    return (state) => {
      if (state.pose) {
        const p = state.pose;
        mesh.matrix.set(p[0], p[1], p[2], p[9], p[3], p[4], p[5], p[10], p[6], p[7], p[8], p[11], 0, 0, 0, 1);
        mesh.matrixWorldNeedsUpdate = true;
      } else {
        const points = floats(state.points);
        first = first || points;
        const all = first.slice();  // the first view has all points, others only the changed range
        all.set(points, 3 * state.from);
        geometry.setAttribute("position", new THREE.BufferAttribute(all, 3));
        if (!material.flatShading) geometry.computeVertexNormals();
      }
    };
  }
  const unit = {
    sphere: () => new THREE.SphereBufferGeometry(1, 24, 16),
    box: () => new THREE.BoxBufferGeometry(2, 2, 2),
    cylinder: () => new THREE.CylinderBufferGeometry(1, 1, 2, 40).rotateX(Math.PI / 2),
    plane: () => new THREE.PlaneBufferGeometry(2, 2),
  };
  function solids(object) {
    const plane = object.kind === "plane";
    const material = new THREE.MeshLambertMaterial({ color: object.colour, side: THREE.DoubleSide, transparent: plane, opacity: plane ? 0.35 : 1 });
    const words = object.kind === "sphere" ? 4 : 12;
    let mesh = null;
    return (state) => {
      const w = floats(state.placements), count = w.length / words, m = new THREE.Matrix4();
      if (!mesh) {
        mesh = new THREE.InstancedMesh(unit[object.kind](), material, count);
        mesh.frustumCulled = false;
        scene.add(mesh);
      }
      for (let i = 0; i < count; ++i) {
        const p = w.subarray(words * i, words * (i + 1));
        if (words === 4) m.set(p[3], 0, 0, p[0], 0, p[3], 0, p[1], 0, 0, p[3], p[2], 0, 0, 0, 1);
        else m.set(p[0], p[1], p[2], p[9], p[3], p[4], p[5], p[10], p[6], p[7], p[8], p[11], 0, 0, 0, 1);
        mesh.setMatrixAt(i, m);
      }
      mesh.instanceMatrix.needsUpdate = true;
    };
  }
  function lines(group, colour, opacity) {
    const geometry = new THREE.BufferGeometry();
    const made = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: colour, transparent: true, opacity }));
    made.frustumCulled = false;
    group.add(made);
    return (ends) => geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(ends), 3));
  }
  function rays() {
    const met = lines(layers.rays, "#ffb454", 0.85), missed = lines(layers.rays, "#6f9bd1", 0.45);
    return (state) => {
      const w = floats(state.rays), ends = [[], []];
      for (let i = 0; i < w.length; i += 7) ends[w[i + 6]].push(...w.subarray(i, i + 6));
      missed(ends[0]);
      met(ends[1]);
    };
  }
  // A round dot. Points in WebGL are squares.
  const disc = document.createElement("canvas").getContext("2d");
  disc.canvas.width = disc.canvas.height = 32;
  disc.fillStyle = "#fff";
  disc.arc(16, 16, 15, 0, 2 * Math.PI);
  disc.fill();
  const dot = new THREE.CanvasTexture(disc.canvas);
  function hits(query) {
    const stride = query.normals ? 7 : 4, colour = query.rays ? "#ff6a4d" : "#5fe0b0";
    const geometry = new THREE.BufferGeometry();
    const material = new THREE.PointsMaterial({ color: colour, size: 7 * Math.min(devicePixelRatio, 2), map: dot, alphaTest: 0.5,
      sizeAttenuation: false, depthTest: query.rays });
    const points = new THREE.Points(geometry, material);
    points.frustumCulled = false;
    layers.hits.add(points);
    const normals = lines(layers.hits, colour, 0.9), apart = lines(layers.hits, "#e9edf2", 0.9);
    return (state) => {
      const w = floats(state.words), at = [], ends = [];
      for (let i = 0; i < w.length; i += stride) {
        at.push(w[i], w[i + 1], w[i + 2]);
        if (query.normals) for (const s of [0, 0.04 * size]) ends.push(w[i] + s * w[i + 4], w[i + 1] + s * w[i + 5], w[i + 2] + s * w[i + 6]);
      }
      geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(at), 3));
      normals(ends);
      // The closest points of solids that miss are CP ∓ T n / 2.
      const misses = floats(state.apart), segments = [];
      for (let i = 0; i < misses.length; i += 7)
        for (const half of [-misses[i + 3] / 2, misses[i + 3] / 2]) for (let k = 0; k < 3; ++k) segments.push(misses[i + k] + half * misses[i + 4 + k]);
      apart(segments);
    };
  }
  const objects = data.objects.map((o) => o.kind === "surface" ? surface(o) : o.kind === "rays" ? rays() : solids(o));
  const queries = data.queries.map(hits);

  // The camera turns about the middle of the scene.
  const target = vector(data.camera.target), away = new THREE.Spherical();
  // Camera angles are about y, for any up axis.
  const toUp = new THREE.Quaternion(), fromUp = new THREE.Quaternion(), home = new THREE.Vector3();
  const zAxis = new THREE.Vector3(0, 0, 1), yAxis = new THREE.Vector3(0, 1, 0);
  function setUp(axis) {
    camera.up.set(axis === "x" ? 1 : 0, axis === "y" ? 1 : 0, axis === "z" ? 1 : 0);
    sky.position.copy(camera.up);
    toUp.setFromUnitVectors(camera.up, yAxis);
    fromUp.copy(toUp).inverse();
    home.copy(vector(data.camera.eye)).sub(vector(data.camera.target));
    if (axis !== "z") home.setLength(Math.max(home.length(), 0.55 * size / Math.tan(data.camera.fov * Math.PI / 360)));
    home.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(zAxis, yAxis));
  }
  function reset() {
    target.copy(vector(data.camera.target));
    away.setFromVector3(home);
    draw();
  }
  // Draws a scale with a round length for the middle of the view, and the directions of x, y and z.
  const scale = document.getElementById("scale"), axes = document.getElementById("axes");
  scale.removeAttribute("hidden");
  axes.removeAttribute("hidden");
  function drawScale(height) {
    const pixel = 2 * away.radius * Math.tan(camera.fov * Math.PI / 360) / height, most = 150 * pixel;
    const power = 10 ** Math.floor(Math.log10(most)), length = power * [5, 2, 1].find((f) => f * power <= most);
    const left = (196 - length / pixel).toFixed(1), text = Number(length.toPrecision(3)) + (length === 1 ? " unit" : " units");
    scale.querySelector("path").setAttribute("d", `M${left} 22v8h${(length / pixel).toFixed(1)}v-8`);
    scale.querySelector("text").textContent = text;
    scale.setAttribute("aria-label", "Scale in the middle of the view: " + text);
  }
  function drawAxes() {
    const back = camera.quaternion.clone().inverse();
    axes.replaceChildren(...["x", "y", "z"].map((name, k) => {
      const v = new THREE.Vector3().setComponent(k, 1).applyQuaternion(back);
      return { name, v };
    }).sort((a, b) => a.v.z - b.v.z).flatMap(({ name, v }) => {
      const make = (tag, set) => {
        const e = document.createElementNS("http://www.w3.org/2000/svg", tag);
        for (const [key, value] of Object.entries({ class: name, ...set })) e.setAttribute(key, value);
        return e;
      };
      const line = make("line", { x1: 42, y1: 42, x2: 42 + 28 * v.x, y2: 42 - 28 * v.y });
      const text = make("text", { x: 42 + 36 * v.x, y: 46 - 36 * v.y, "text-anchor": "middle" });
      text.textContent = name;
      return [line, text];
    }));
  }
  let waiting = false;
  function draw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      const width = stage.clientWidth, height = Math.round(Math.max(260, Math.min(width / 2, 0.8 * innerHeight)));
      const ratio = Math.min(devicePixelRatio, 2);
      if (canvas.width !== Math.floor(width * ratio) || canvas.height !== Math.floor(height * ratio)) {
        renderer.setPixelRatio(ratio);
        renderer.setSize(width, height, false);
      }
      camera.aspect = width / height;
      // On narrow screens the width limits the view.
      camera.fov = 2 * Math.atan(Math.tan(data.camera.fov * Math.PI / 360) * Math.max(1, 2 / camera.aspect)) * 180 / Math.PI;
      camera.position.setFromSpherical(away).applyQuaternion(fromUp).add(target);
      camera.lookAt(target);
      camera.updateProjectionMatrix();
      renderer.render(scene, camera);
      drawScale(height);
      drawAxes();
    });
  }
  function turn(dx, dy) {
    away.theta -= dx;
    away.phi = Math.min(Math.max(away.phi - dy, 0.02), Math.PI - 0.02);
    draw();
  }
  function zoom(factor) {
    away.radius = Math.min(Math.max(away.radius * factor, 0.005 * size), 20 * size);
    draw();
  }
  function pan(dx, dy) {
    const unitLength = away.radius * Math.tan(camera.fov * Math.PI / 360) * 2 / canvas.clientHeight;
    const x = new THREE.Vector3().setFromMatrixColumn(camera.matrix, 0), y = new THREE.Vector3().setFromMatrixColumn(camera.matrix, 1);
    target.addScaledVector(x, -dx * unitLength).addScaledVector(y, dy * unitLength);
    draw();
  }
  const held = new Map();
  canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); held.set(e.pointerId, [e.clientX, e.clientY]); });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (e) => held.delete(e.pointerId));
  canvas.addEventListener("pointermove", (e) => {
    const last = held.get(e.pointerId);
    if (!last) return pick(e);
    const dx = e.clientX - last[0], dy = e.clientY - last[1];
    if (held.size === 2) {
      const other = [...held].find(([id]) => id !== e.pointerId)[1];
      const before = Math.hypot(last[0] - other[0], last[1] - other[1]), now = Math.hypot(e.clientX - other[0], e.clientY - other[1]);
      zoom(before / Math.max(now, 1));
      pan(dx / 2, dy / 2);
    } else if (e.shiftKey || e.buttons === 2) pan(dx, dy);
    else turn(dx * 0.006, dy * 0.006);
    held.set(e.pointerId, [e.clientX, e.clientY]);
  });
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("wheel", (e) => { e.preventDefault(); zoom(Math.exp(0.001 * e.deltaY)); }, { passive: false });
  canvas.addEventListener("keydown", (e) => {
    const step = 0.12;
    const act = { ArrowLeft: () => turn(-step, 0), ArrowRight: () => turn(step, 0), ArrowUp: () => turn(0, -step), ArrowDown: () => turn(0, step),
      "+": () => zoom(0.85), "=": () => zoom(0.85), "-": () => zoom(1 / 0.85) }[e.key];
    if (act) { act(); e.preventDefault(); }
  });

  // Describes the hit under the pointer.
  const readout = document.getElementById("readout");
  let shown = 0;
  function pick(e) {
    const box = canvas.getBoundingClientRect(), p = new THREE.Vector3();
    let best = null, least = 10;
    if (layers.hits.visible) data.queries.forEach((query, q) => {
      const state = data.views[shown].queries[q], stride = query.normals ? 7 : 4;
      state.f = state.f || floats(state.words);
      state.n = state.n || new Uint32Array(bytes(state.numbers));
      for (let i = 0; i * stride < state.f.length; ++i) {
        const w = state.f.subarray(i * stride, i * stride + 4);
        p.set(w[0], w[1], w[2]).project(camera);
        if (p.z > 1) continue;
        const d = Math.hypot((p.x + 1) / 2 * box.width + box.left - e.clientX, (1 - p.y) / 2 * box.height + box.top - e.clientY);
        if (d < least) { least = d; best = [query, state.n[2 * i], state.n[2 * i + 1], w]; }
      }
    });
    if (!best) { describe(); return; }
    const [query, primary, index, w] = best, n = (x) => x.toPrecision(6);
    readout.textContent = `${query.name} (${query.pair}): primary ${primary}, secondary ${index}, T ${n(w[3])}, CP ${n(w[0])}, ${n(w[1])}, ${n(w[2])}`;
  }
  function describe() {
    const view = data.views[shown], result = data.frame_results.find((p) => p.frame === view.frame);
    const ms = 1e3 * result.modelled_seconds.reduce((a, b) => a + b);
    readout.textContent = `${result.records.toLocaleString("en")} records, ${result.hits.toLocaleString("en")} hits, ${ms.toPrecision(3)} ms modelled`;
  }

  const slider = document.getElementById("frame"), output = document.getElementById("frame-text"), play = document.getElementById("play");
  const bars = [...document.querySelectorAll("#split .bar")];
  slider.max = data.views.length - 1;
  function show(number) {
    shown = number;
    const view = data.views[number];
    // A null state means the state of the first view.
    view.objects.forEach((state, i) => objects[i](state || data.views[0].objects[i]));
    view.queries.forEach((state, i) => queries[i](state));
    slider.value = number;
    output.textContent = `frame ${view.frame}, ${view.seconds.toFixed(3)} s`;
    slider.setAttribute("aria-valuetext", output.textContent);
    const at = data.frame_results.findIndex((p) => p.frame === view.frame);
    bars.forEach((bar, i) => bar.classList.toggle("chosen", i === Math.floor(at * bars.length / data.frame_results.length)));
    describe();
    draw();
  }
  slider.addEventListener("input", () => show(Number(slider.value)));
  bars.forEach((bar, i) => bar.addEventListener("click", () => {
    const frame = data.frame_results[Math.floor(i * data.frame_results.length / bars.length)].frame;
    let nearest = 0;
    data.views.forEach((v, k) => { if (Math.abs(v.frame - frame) < Math.abs(data.views[nearest].frame - frame)) nearest = k; });
    show(nearest);
  }));
  let timer = 0;
  play.addEventListener("click", () => {
    if (timer) { clearInterval(timer); timer = 0; }
    else timer = setInterval(() => show((shown + 1) % data.views.length), 1000 * data.interval);
    play.textContent = timer ? "Pause" : "Play";
  });
  if (data.views.length < 2) for (const e of [slider, play]) e.hidden = true;
  for (const name of Object.keys(layers)) {
    document.getElementById("show-" + name)?.addEventListener("change", (e) => { layers[name].visible = e.target.checked; draw(); });
  }
  document.getElementById("reset").addEventListener("click", reset);
  document.getElementById("up").addEventListener("change", (e) => { setUp(e.target.value); reset(); });
  addEventListener("resize", draw);
  setUp("z");
  show(0);
  reset();
})();
