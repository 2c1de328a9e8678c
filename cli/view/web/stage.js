// SPDX-License-Identifier: MIT
// The place where particles are drawn: camera, mouse, cut plane, the box that repeats, how many particles a moving picture has.
// Its units are those of the first frame's longest side, so that single-precision numbers of a GPU do for metres of any size.
import {BoxGeometry, Color, EdgesGeometry, LineBasicMaterial, LineSegments, PerspectiveCamera, Raycaster, Scene, Vector2, Vector3,
  WebGLRenderer} from "three";
import {OrbitControls} from "three/addons/controls/OrbitControls.js";
import {Axes} from "./axes.js";
import {Cloud} from "./cloud.js";
import {Nodes} from "./nodes.js";

const kSlow = 1000 / 30;  // ms of a frame, beyond which a moving picture shows a part
const kLeast = 20000;     // particles of such a part
const kFirst = 100000;    // particles with which a picture begins to move: what a machine can do is found from there on
const kCoarse = 0.25;     // of the pixels along each side, at least, where that part is slow too
const kSettles = 200;     // ms

// The box that repeats at a step (model/contract/box_deformation.h).
function box_at({periodic, deform}, step) {
  if (!deform) return periodic;
  const {origin, extent, strain, per_step} = deform;
  return {origin, extent: extent.map((length, k) => length * (1 + strain[k] + step * per_step[k]))};
}

export class Stage {
  // `box`: step, lower and extent in m of the frame that the camera begins with.
  constructor(canvas, head, box, axes) {
    this.renderer = new WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: false});
    this.renderer.setClearColor(new Color("#ffffff"));
    this.renderer.localClippingEnabled = true;
    this.scene = new Scene();
    this.cloud = new Cloud();
    this.scene.add(this.cloud.points);
    this.camera = new PerspectiveCamera(30, 1, 0.001, 1000);
    this.axes = new Axes(axes);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.size = Math.max(...box.extent, 2 * head.radius) || 1;
    this.middle = box.lower.map((low, k) => low + box.extent[k] / 2);
    this.extent = box.extent.map((length) => length / this.size);
    this.radius = head.radius / this.size;
    this.bounds = {middle: [0, 0, 0], extent: this.extent, beyond: this.radius};  // of what is looked at
    this.share = this.sharp = this.sharp_now = 1;
    this.moving = false;
    this.times = [];
    this.head = head;
    this.repeats(box_at(head, box.step));
    this.look(this.thin() ?? "corner");
    this.controls.addEventListener("start", () => { this.held = true; this.move(); });
    this.controls.addEventListener("end", () => { this.held = false; this.move(); });
    this.controls.addEventListener("change", () => this.move());
    new ResizeObserver(() => { this.fit(); this.draw(); }).observe(canvas.parentElement);
    this.fit();
  }

  // Another picture that sees from where this one does.
  lead(other) {
    const follow = () => {
      const {position, up} = other.camera, {target} = other.controls;
      // Controls round, and would else answer one another for ever.
      const apart = (a, b) => a.distanceToSquared(b) > 1e-12;
      if (!apart(position, this.camera.position) && !apart(target, this.controls.target) && !apart(up, this.camera.up)) return;
      position.copy(this.camera.position), up.copy(this.camera.up), target.copy(this.controls.target);
      Object.assign(other.camera, {near: this.camera.near, far: this.camera.far});
      other.camera.updateProjectionMatrix();
      other.controls.update();
      other.draw();
    };
    this.controls.addEventListener("change", follow);
    follow();
  }
  inner(place) {
    return place.map((x, k) => (x - this.middle[k]) / this.size);
  }
  // The axis along which a flat body is thin.
  thin() {
    const least = Math.min(...this.extent), axis = this.extent.indexOf(least);
    return least < 0.08 ? "xyz"[axis] : undefined;
  }
  look(from) {
    const ways = {x: [1, 0, 0], y: [0, -1, 0], z: [0, 0, 1], corner: [0.55, -0.7, 0.45]};
    const up = from === "z" ? [0, 1, 0] : [0, 0, 1];
    // So far that a sphere about the body fits the narrower of the two angles.
    const half = (this.camera.fov * Math.PI) / 360, narrow = Math.atan(Math.tan(half) * Math.min(1, this.camera.aspect || 1));
    const flat = {x: [1, 2], y: [0, 2], z: [0, 1]}[from];
    const {middle, extent, beyond} = this.bounds;
    const reach = (flat ? Math.hypot(extent[flat[0]], extent[flat[1]]) : Math.hypot(...extent)) / 2 + beyond;
    const distance = (1.02 * reach) / Math.sin(narrow);
    this.camera.up.fromArray(up);
    this.camera.position.fromArray(ways[from]).normalize().multiplyScalar(distance).add(new Vector3(...middle));
    this.camera.near = distance / 100;
    this.camera.far = distance * 100;
    this.camera.updateProjectionMatrix();
    this.controls.target.set(...middle);
    this.from = from;
    this.controls.update();
    this.draw();
  }
  repeats({origin, extent}) {
    if (!extent.some((length) => length > 0)) return;
    const sides = extent.map((length, k) => (length > 0 ? length / this.size : this.extent[k]));
    if (this.box) this.scene.remove(this.box), this.box.geometry.dispose(), this.box.material.dispose();
    const box = this.box = new LineSegments(new EdgesGeometry(new BoxGeometry(...sides)), new LineBasicMaterial({color: "#999999"}));
    const low = origin.map((x, k) => (extent[k] > 0 ? x : this.middle[k] - (this.extent[k] * this.size) / 2));
    box.position.fromArray(this.inner(low.map((x, k) => x + (sides[k] * this.size) / 2)));
    this.scene.add(box);
  }
  fit() {
    const {clientWidth: width, clientHeight: height} = this.renderer.domElement.parentElement;
    if (!width || !height) return;
    const before = this.camera.aspect;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2) * this.sharp_now);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (Math.abs(before - this.camera.aspect) > 0.2 && this.from) this.look(this.from);
  }

  show(places, box) {
    if (this.head.deform) this.repeats(box_at(this.head, box.step));
    if (this.cloud.count === 0) this.share = Math.min(1, (3 * kFirst) / Math.max(1, places.length));
    this.cloud.place(places, {lower: this.inner(box.lower), extent: box.extent.map((length) => length / this.size)});
  }
  // Particles, or nodes, beyond the plane, at `share` of the body along the axis, are not drawn. No axis: all are.
  cut(axis, share, turned) {
    const k = "xyz".indexOf(axis), sign = turned ? -1 : 1, normal = [0, 0, 0], {middle, extent, beyond} = this.bounds;
    if (axis) normal[k] = sign;
    const half = axis ? extent[k] / 2 + beyond : 0, reach = axis ? sign * (middle[k] - half + 2 * half * share) : 1;
    this.cloud.material.uniforms.cut.value.set(...normal, reach);
    this.nodes?.cut(normal, reach);
  }

  // The machine's nodes in the place of particles, or particles again.
  build(words, machine) {
    this.nodes = new Nodes(words, machine, (place) => this.inner(place), this.size);
    this.scene.add(this.nodes.group);
  }
  swap(machine) {
    this.bounds = machine ? {...this.nodes.bounds, beyond: 0} : {middle: [0, 0, 0], extent: this.extent, beyond: this.radius};
    this.cloud.points.visible = !machine;
    if (this.nodes) this.nodes.group.visible = machine;
    if (this.from) this.look(this.from);
  }

  // Pictures follow one another until nothing has moved for a while; so what one takes is the time between two.
  move() {
    this.moving = true;
    clearTimeout(this.settles);
    this.settles = setTimeout(() => {
      if (this.held) return;
      this.moving = false;
      this.draw();
    }, kSettles);
    this.draw();
  }
  draw() {
    if (this.asked) return;
    this.asked = requestAnimationFrame(() => {
      this.asked = 0;
      this.draw_now();
    });
  }
  sharpen(sharp) {
    if (sharp === this.sharp_now) return;
    this.sharp_now = sharp;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2) * sharp);
  }
  // With all particles and pixels, also while it moves.
  draw_whole() {
    const {moving} = this;
    this.moving = false;
    this.draw_now();
    this.moving = moving;
  }
  draw_now() {
    this.sharpen(this.moving ? this.sharp : 1);
    const uniforms = this.cloud.material.uniforms;
    const height = this.renderer.domElement.height;
    uniforms.pixels.value = height / (2 * Math.tan((this.camera.fov * Math.PI) / 360));
    const larger = this.cloud.detail(this.moving ? this.share : 1);
    uniforms.radius.value = this.radius * larger;
    this.renderer.render(this.scene, this.camera);
    this.axes.turn(this.camera.matrixWorldInverse);
    this.drawn_particles = this.cloud.geometry.drawRange.count;
    const now = performance.now();
    if (this.moving && this.last) this.learn(now - this.last);
    this.last = this.moving ? now : 0;
    if (this.moving) this.draw();
  }
  // How large a part 30 pictures a second allow, and how many pixels, from how long the last few took.
  learn(took) {
    this.times.push(took);
    if (this.times.length < 3 && took < 4 * kSlow) return;
    const middle = this.times.sort((a, b) => a - b)[this.times.length >> 1];
    this.times = [];
    const least = Math.min(1, kLeast / Math.max(1, this.cloud.count));
    if (middle > 1.15 * kSlow) {
      if (this.share > least) this.share = Math.max(least, this.share * Math.max(0.02, kSlow / middle));
      else this.sharp = Math.max(kCoarse, this.sharp * Math.sqrt(Math.max(0.25, kSlow / middle)));
    } else if (middle < 0.6 * kSlow) {
      if (this.sharp < 1) this.sharp = Math.min(1, this.sharp * 1.2);
      else this.share = Math.min(1, this.share * 1.5);
    }
  }
  // A PNG of what is seen, as a blob.
  picture() {
    this.draw_whole();
    return new Promise((done) => this.renderer.domElement.toBlob(done, "image/png"));
  }

  // The node under a point of the canvas, in CSS pixels; -1: none.
  pick_node(x, y) {
    const {clientWidth: width, clientHeight: height} = this.renderer.domElement, ray = new Raycaster();
    this.camera.updateMatrixWorld();
    ray.setFromCamera(new Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.camera);
    return this.nodes.pick(ray.ray);
  }
  // The particle under a point of the canvas, in CSS pixels; -1: none. The nearest of those whose discs hold the point.
  pick(x, y) {
    const canvas = this.renderer.domElement, width = canvas.clientWidth, height = canvas.clientHeight;
    const {lower, extent, cut} = this.cloud.material.uniforms, places = this.cloud.places, p = new Vector3();
    const scale = height / (2 * Math.tan((this.camera.fov * Math.PI) / 360));
    const at = new Vector2(x, y);
    let found = -1, nearest = Infinity;
    this.camera.updateMatrixWorld();
    const seen = this.camera.matrixWorldInverse;
    for (let k = 0; k < this.cloud.count; ++k) {
      if (places[3 * k] === 65535) continue;
      p.set(places[3 * k], places[3 * k + 1], places[3 * k + 2]).divideScalar(65534).multiply(extent.value).add(lower.value);
      if (cut.value.x * p.x + cut.value.y * p.y + cut.value.z * p.z > cut.value.w) continue;
      p.applyMatrix4(seen);
      const depth = -p.z;
      if (depth <= this.camera.near || depth >= nearest) continue;
      const dx = width / 2 + (p.x / depth) * scale - at.x, dy = height / 2 - (p.y / depth) * scale - at.y;
      const reach = Math.max((this.radius * scale) / depth, 3);
      if (dx * dx + dy * dy <= reach * reach) nearest = depth, found = k;
    }
    return found;
  }
  // Of a particle that has a place, in the scene's own units.
  place_of(index) {
    const {lower, extent} = this.cloud.material.uniforms, {places} = this.cloud;
    return new Vector3().fromArray(places, 3 * index).divideScalar(65534).multiply(extent.value).add(lower.value);
  }
  // The point under a point of the canvas that is as deep as `place`.
  across(place, x, y) {
    const {clientWidth: width, clientHeight: height} = this.renderer.domElement;
    this.camera.updateMatrixWorld();
    const depth = place.clone().project(this.camera).z;
    return new Vector3((2 * x) / width - 1, 1 - (2 * y) / height, depth).unproject(this.camera);
  }
  choose(index) {
    this.cloud.material.uniforms.chosen.value = index;
    this.draw();
  }
}
