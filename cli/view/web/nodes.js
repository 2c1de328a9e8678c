// SPDX-License-Identifier: MIT
// The machine's nodes as boxes at the place of their cells, the links between them, and arrows from those that wait to whom they wait for.
import {BoxGeometry, BufferAttribute, BufferGeometry, ConeGeometry, Group, InstancedBufferAttribute, InstancedBufferGeometry, InstancedMesh, LineBasicMaterial,
  LineSegments, Matrix4, Mesh, MeshBasicMaterial, Plane, Quaternion, ShaderMaterial, Vector2, Vector3, Vector4} from "three";
import {texture_of} from "./cloud.js";
import {kNeighbours, kNodeWords} from "./spans.js";

const kPart = 0.5;        // of its cells' length that a box has
const kWaiting = 0.45;    // of its light that a waiting one has

const kVertex = `
attribute vec3 centre, sides;
attribute float value, waits;
uniform vec4 cut;
uniform vec2 range;
uniform int chosen;
varying float share, light, marked;
varying vec2 place;
void main() {
  bool gone = dot(cut.xyz, centre) > cut.w;
  gl_Position = gone ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * modelViewMatrix * vec4(centre + position * sides, 1.0);
  marked = gl_InstanceID == chosen ? 1.0 : 0.0;
  light = (0.6 + 0.4 * max(normalize(normalMatrix * normal).z, 0.0)) * (waits > 0.5 ? ${kWaiting} : 1.0);
  share = value == value ? clamp((value - range.x) / (range.y - range.x), 0.0, 1.0) : -1.0;
  place = uv;
}`;
const kFragment = `
uniform sampler2D colours;
varying float share, light, marked;
varying vec2 place;
void main() {
  vec3 colour = share < 0.0 ? vec3(0.8) : texture2D(colours, vec2(share * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb;
  vec2 within = min(place, 1.0 - place);
  float rim = min(within.x, within.y);
  if (marked > 0.5 && rim < 0.14) gl_FragColor = vec4(1.0, 0.0, 0.6, 1.0);
  else gl_FragColor = vec4(colour * light * (rim < 0.04 ? 0.75 : 1.0), 1.0);
}`;

const kWays = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];

export class Nodes {
  // `words`: the block of nodes; `machine`: of the story; `inner`: from m to the picture's own units; `size`: m of such a unit.
  constructor(words, machine, inner, size) {
    const count = machine.nodes, {edge, brick, origin} = machine;
    this.words = words, this.count = count;
    this.centres = new Float32Array(3 * count);
    this.whole = edge.map((length, k) => (length * brick[k]) / size);
    this.sides = this.whole.map((length) => kPart * length);
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let n = 0; n < count; ++n) {
      const at = inner([0, 1, 2].map((k) => origin[k] + (words[n * kNodeWords + k] + brick[k] / 2) * edge[k]));
      at.forEach((x, k) => {
        this.centres[3 * n + k] = x;
        low[k] = Math.min(low[k], x - this.whole[k] / 2), high[k] = Math.max(high[k], x + this.whole[k] / 2);
      });
    }
    this.bounds = {middle: low.map((x, k) => (x + high[k]) / 2), extent: low.map((x, k) => high[k] - x)};
    const geometry = new InstancedBufferGeometry();
    const box = new BoxGeometry(1, 1, 1);
    geometry.index = box.index;
    for (const name of ["position", "normal", "uv"]) geometry.setAttribute(name, box.attributes[name]);
    geometry.instanceCount = count;
    const sides = new Float32Array(3 * count);
    for (let n = 0; n < count; ++n) sides.set(this.sides, 3 * n);
    geometry.setAttribute("centre", new InstancedBufferAttribute(this.centres, 3));
    geometry.setAttribute("sides", new InstancedBufferAttribute(sides, 3));
    this.values = new Float32Array(count), this.waits = new Float32Array(count);
    geometry.setAttribute("value", new InstancedBufferAttribute(this.values, 1));
    geometry.setAttribute("waits", new InstancedBufferAttribute(this.waits, 1));
    this.geometry = geometry;
    this.material = new ShaderMaterial({vertexShader: kVertex, fragmentShader: kFragment, uniforms: {
      cut: {value: new Vector4(0, 0, 0, 1)}, range: {value: new Vector2(0, 1)}, chosen: {value: -1}, colours: {value: null}}});
    this.plane = new Plane(new Vector3(0, 0, 0), 1);
    this.group = new Group();
    const boxes = new Mesh(geometry, this.material);
    boxes.frustumCulled = false;
    this.arrow = new ConeGeometry(0.13 * Math.min(...this.whole), 0.42 * Math.min(...this.whole), 10);
    this.pointing = new MeshBasicMaterial({color: "#c2185b", clippingPlanes: [this.plane]});
    this.group.add(boxes, this.links());
  }
  links() {
    const ends = [];
    for (let n = 0; n < this.count; ++n)
      for (const face of [1, 3, 5]) {
        const other = this.words[n * kNodeWords + kNeighbours + face], k = face >> 1;
        // One that closes a ring would go through all others.
        if (other < 0 || this.centres[3 * other + k] <= this.centres[3 * n + k]) continue;
        ends.push(...this.centres.subarray(3 * n, 3 * n + 3), ...this.centres.subarray(3 * other, 3 * other + 3));
      }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
    return new LineSegments(geometry, new LineBasicMaterial({color: "#c3c9ce", clippingPlanes: [this.plane]}));
  }
  cut(normal, reach) {
    this.material.uniforms.cut.value.set(...normal, reach);
    this.plane.normal.set(...normal).negate();
    this.plane.constant = reach;
  }
  // `table`: 256 colours; `waits`: a number for each node, 1 of those that wait; nothing: none does.
  colour(values, waits, low, high, table, smooth) {
    this.values.set(values);
    waits ? this.waits.set(waits) : this.waits.fill(0);
    for (const name of ["value", "waits"]) this.geometry.getAttribute(name).needsUpdate = true;
    this.material.uniforms.range.value.set(low, high);
    this.material.uniforms.colours.value?.dispose();
    this.material.uniforms.colours.value = texture_of(table, smooth);
  }
  // Of {node, face}: from the node's side over that face.
  arrows(list) {
    if (this.shown) this.group.remove(this.shown), this.shown.dispose();
    this.shown = null;
    this.pointed = list.length;
    if (list.length === 0) return;
    const cones = new InstancedMesh(this.arrow, this.pointing, list.length), matrix = new Matrix4(), turn = new Quaternion(), one = new Vector3(1, 1, 1);
    list.forEach(({node, face}, k) => {
      const way = new Vector3(...kWays[face]);
      turn.setFromUnitVectors(new Vector3(0, 1, 0), way);
      const at = new Vector3().fromArray(this.centres, 3 * node).addScaledVector(way, 0.5 * this.whole[face >> 1]);
      cones.setMatrixAt(k, matrix.compose(at, turn, one));
    });
    cones.frustumCulled = false;
    this.shown = cones;
    this.group.add(cones);
  }
  choose(node) { this.material.uniforms.chosen.value = node; }
  // The nearest box that a ray of the picture meets; -1: none.
  pick(ray) {
    const from = ray.origin.toArray(), way = ray.direction.toArray(), half = this.sides.map((side) => side / 2), {cut} = this.material.uniforms;
    let found = -1, nearest = Infinity;
    for (let n = 0; n < this.count; ++n) {
      const [x, y, z] = this.centres.subarray(3 * n, 3 * n + 3);
      if (cut.value.x * x + cut.value.y * y + cut.value.z * z > cut.value.w) continue;
      let enter = 0, leave = Infinity;
      for (let k = 0; k < 3; ++k) {
        const a = (this.centres[3 * n + k] - half[k] - from[k]) / way[k], b = (this.centres[3 * n + k] + half[k] - from[k]) / way[k];
        // A ray along the faces of an axis gives no number where it lies in one.
        if (way[k] === 0 && Math.abs(from[k] - this.centres[3 * n + k]) <= half[k]) continue;
        enter = Math.max(enter, Math.min(a, b)), leave = Math.min(leave, Math.max(a, b));
      }
      if (enter <= leave && enter < nearest) nearest = enter, found = n;
    }
    return found;
  }
}
