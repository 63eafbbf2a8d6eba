// SPDX-License-Identifier: Apache-2.0
// Shows the wrong pixels on the mesh in 3-D. Without scripts or WebGL only the pictures below are visible.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const section = document.getElementById("in-space"), stage = document.getElementById("stage");
  if (!section || !data.views.length) return;
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });  // kept for print
  } catch (error) {
    return;
  }
  const canvas = renderer.domElement;
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  stage.prepend(canvas);
  section.hidden = false;

  const scene = new THREE.Scene();
  scene.background = new THREE.Color("#10161d");
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(bytes(data.points).buffer), 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytes(data.corners).buffer), 1));
  geometry.computeBoundingSphere();
  const { center, radius } = geometry.boundingSphere;
  // Flat shading needs no normals. The offset keeps points in front of the mesh.
  scene.add(new THREE.Mesh(geometry, new THREE.MeshPhongMaterial({ color: "#8d97a3", side: THREE.DoubleSide, flatShading: true,
    shininess: 0, specular: 0, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4 })));
  scene.add(new THREE.HemisphereLight(0xdfe8f5, 0x6a707a, 0.8));
  const sun = new THREE.DirectionalLight(0xfff4e2, 0.7);
  sun.position.set(-0.55, 0.35, 0.62);
  scene.add(sun);
  const clouds = data.colours.map((color) => {
    const points = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial({ color, size: 5 * Math.min(devicePixelRatio, 2), sizeAttenuation: false }));
    points.frustumCulled = false;
    scene.add(points);
    return points;
  });

  const camera = new THREE.PerspectiveCamera(40, 2, 1e-3 * radius, 50 * radius);
  camera.up.set(0, 0, 1);
  let around = -0.9, above = 0.7, far = 2.6 * radius, waiting = false;
  function draw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      const width = stage.clientWidth, height = Math.round(Math.max(260, Math.min(width / 2, 0.8 * innerHeight)));
      renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.position.set(Math.cos(above) * Math.cos(around), Math.cos(above) * Math.sin(around), Math.sin(above)).multiplyScalar(far).add(center);
      camera.lookAt(center);
      camera.updateProjectionMatrix();
      renderer.render(scene, camera);
    });
  }
  function turn(dx, dy) {
    around -= dx;
    above = Math.min(Math.max(above + dy, -1.55), 1.55);
    draw();
  }
  function zoom(factor) {
    far = Math.min(Math.max(far * factor, 0.02 * radius), 20 * radius);
    draw();
  }
  let last = null;
  canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); last = [e.clientX, e.clientY]; });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { last = null; });
  canvas.addEventListener("pointermove", (e) => {
    if (!last) return;
    turn((e.clientX - last[0]) * 0.006, (e.clientY - last[1]) * 0.006);
    last = [e.clientX, e.clientY];
  });
  canvas.addEventListener("wheel", (e) => { e.preventDefault(); zoom(Math.exp(0.001 * e.deltaY)); }, { passive: false });
  canvas.addEventListener("keydown", (e) => {
    const act = { ArrowLeft: () => turn(0.12, 0), ArrowRight: () => turn(-0.12, 0), ArrowUp: () => turn(0, 0.12), ArrowDown: () => turn(0, -0.12),
      "+": () => zoom(0.85), "=": () => zoom(0.85), "-": () => zoom(1 / 0.85) }[e.key];
    if (act) { act(); e.preventDefault(); }
  });

  const select = document.getElementById("of-pipe"), readout = document.getElementById("readout");
  select.append(...data.views.map((view) => Object.assign(document.createElement("option"), { textContent: view.name })));
  function show() {
    const view = data.views[select.selectedIndex], at = new Float32Array(bytes(view.at).buffer), kinds = bytes(view.kinds);
    clouds.forEach((cloud, kind) => {
      const own = [];
      kinds.forEach((k, i) => { if (k === kind) own.push(...at.subarray(3 * i, 3 * i + 3)); });
      cloud.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(own), 3));
    });
    readout.textContent = view.text;
    canvas.setAttribute("aria-label", `The mesh. ${view.text} Arrow keys turn the view, plus and minus zoom.`);
    draw();
  }
  select.addEventListener("change", show);
  addEventListener("resize", draw);
  show();
})();
