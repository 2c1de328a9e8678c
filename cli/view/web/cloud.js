// SPDX-License-Identifier: MIT
// Particles as shaded discs that face the reader, one draw call for all. Places are whole numbers of 16 bits between the frame's
// bounds; 65535 marks a particle that has none.
import {BufferAttribute, BufferGeometry, DataTexture, LinearFilter, NearestFilter, Points, RGBAFormat, ShaderMaterial, Vector2,
  Vector3, Vector4} from "three";

const kVertex = `
attribute float value;
uniform vec3 lower, extent;
uniform vec4 cut;
uniform vec2 range;
uniform float radius, pixels;
uniform int chosen;
varying float share;
varying float marked;
void main() {
  vec3 place = lower + position * (65535.0 / 65534.0) * extent;
  bool gone = position.x == 1.0 || dot(cut.xyz, place) > cut.w;
  vec4 seen = modelViewMatrix * vec4(place, 1.0);
  gl_Position = gone ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * seen;
  marked = gl_VertexID == chosen ? 1.0 : 0.0;
  // The chosen one is seen through all others.
  if (marked > 0.5 && !gone) gl_Position.z = -0.99 * gl_Position.w;
  gl_PointSize = max(2.0 * radius * pixels / -seen.z, 1.0) * (marked > 0.5 ? 1.6 : 1.0) + 4.0 * marked;
  share = value == value ? clamp((value - range.x) / (range.y - range.x), 0.0, 1.0) : -1.0;
}`;
const kFragment = `
uniform sampler2D colours;
varying float share;
varying float marked;
void main() {
  vec2 at = 2.0 * gl_PointCoord - 1.0;
  float square = dot(at, at);
  if (square > 1.0) discard;
  float light = 0.62 + 0.38 * sqrt(1.0 - square);
  vec3 colour = share < 0.0 ? vec3(0.6) : texture2D(colours, vec2(share * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb;
  if (marked > 0.5 && square > 0.55) { colour = vec3(1.0, 0.0, 0.6); light = 1.0; }
  gl_FragColor = vec4(colour * light, 1.0);
}`;

// An order in which each beginning is spread over all: a part of it stands for the whole. The stride shares no factor with the count.
function spread(count) {
  const gcd = (a, b) => (b === 0 ? a : gcd(b, a % b));
  let stride = Math.max(1, Math.round(count * 0.6180339887));
  while (gcd(stride, count) !== 1) ++stride;
  const order = new Uint32Array(count);
  for (let k = 0, at = 0; k < count; ++k, at = (at + stride) % count) order[k] = at;
  return order;
}

// 256 colours as a texture.
export function texture_of(bytes, smooth) {
  const made = new DataTexture(bytes, 256, 1, RGBAFormat);
  made.magFilter = made.minFilter = smooth ? LinearFilter : NearestFilter;
  made.needsUpdate = true;
  return made;
}

export class Cloud {
  constructor() {
    this.geometry = new BufferGeometry();
    this.count = 0;
    this.material = new ShaderMaterial({vertexShader: kVertex, fragmentShader: kFragment, uniforms: {
      lower: {value: new Vector3()}, extent: {value: new Vector3(1, 1, 1)}, cut: {value: new Vector4(0, 0, 0, 1)},
      range: {value: new Vector2(0, 1)}, radius: {value: 1}, pixels: {value: 1}, chosen: {value: -1}, colours: {value: null}}});
    this.points = new Points(this.geometry, this.material);
    this.points.frustumCulled = false;
  }
  // `box`: lower and extent in the scene's own units.
  place(places, box) {
    const count = places.length / 3;
    if (count !== this.count) {
      this.geometry.dispose();
      this.geometry = new BufferGeometry();
      this.geometry.setIndex(new BufferAttribute(spread(count), 1));
      this.points.geometry = this.geometry;
      this.count = count;
    }
    this.set("position", places, 3, true);
    this.material.uniforms.lower.value.fromArray(box.lower);
    this.material.uniforms.extent.value.fromArray(box.extent);
    this.places = places;
  }
  colour(values, low, high) {
    this.set("value", values, 1, false);
    this.values = values;
    this.range(low, high);
  }
  range(low, high) {
    this.material.uniforms.range.value.set(low, high);
  }
  table(bytes, smooth) {
    this.material.uniforms.colours.value?.dispose();
    this.material.uniforms.colours.value = texture_of(bytes, smooth);
  }
  // The buffer of before is written over where the size is the same.
  set(name, values, numbers, normalised) {
    const there = this.geometry.getAttribute(name);
    if (there && there.array.length === values.length) {
      there.array = values;
      there.needsUpdate = true;
    } else {
      this.geometry.setAttribute(name, new BufferAttribute(values, numbers, normalised));
    }
  }
  // A part of the particles, larger so that the body stays closed: a share s of them at 1 / cbrt(s) of the radius.
  detail(share) {
    this.geometry.setDrawRange(0, Math.max(1, Math.ceil(this.count * share)));
    return 1 / Math.cbrt(share);
  }
}
