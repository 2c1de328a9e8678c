// SPDX-License-Identifier: MIT
// A mouse that takes hold of particles: it draws how they are to go, within the plane of the screen.
import {ArrowHelper, Mesh, MeshBasicMaterial, SphereGeometry, Vector3} from "three";
import {by_id} from "./format.js";

const kBall = "#d55e00", kArrow = "#0b57a4";

export class Hand {
  // `pull`: is called with the particle's id and its way in m.
  constructor(page, pull) {
    this.page = page;
    this.pull = pull;
    const canvas = by_id("canvas");
    const on = (event, work) => canvas.addEventListener(event, (at) => {
      const box = canvas.getBoundingClientRect();
      page.attempt(() => work(at.clientX - box.left, at.clientY - box.top, at.pointerId));
    });
    on("pointerdown", (x, y, pointer) => this.take(x, y, pointer));
    on("pointermove", (x, y) => this.draw(x, y));
    on("pointerup", (x, y) => this.release(x, y));
    on("pointercancel", () => this.let_go());
    by_id("pull").addEventListener("change", () => {
      page.stage.controls.enabled = !by_id("pull").checked;
      this.let_go();
    });
  }
  take(x, y, pointer) {
    const {stage} = this.page;
    if (!by_id("pull").checked || this.page.nodes_shown()) return;
    const place = stage.pick(x, y);
    if (place < 0) return;
    this.let_go();
    by_id("canvas").setPointerCapture(pointer);
    this.held = {place, from: stage.place_of(place), x, y};
    const radius = Math.max(stage.radius, (by_id("pull-radius").valueAsNumber || 0) / stage.size);
    this.ball = new Mesh(new SphereGeometry(radius, 24, 16), new MeshBasicMaterial({color: kBall, opacity: 0.25, transparent: true, depthTest: false}));
    this.ball.position.copy(this.held.from);
    this.arrow = new ArrowHelper(new Vector3(1, 0, 0), this.held.from, 1e-6, kArrow);
    for (const part of [this.arrow.line, this.arrow.cone]) Object.assign(part.material, {depthTest: false, transparent: true}), part.renderOrder = 2;
    this.ball.renderOrder = 1;
    stage.scene.add(this.ball, this.arrow);
    stage.draw();
  }
  way(x, y) {
    return this.page.stage.across(this.held.from, x, y).sub(this.held.from);
  }
  draw(x, y) {
    if (!this.held) return;
    const way = this.way(x, y), length = way.length();
    if (length > 0) this.arrow.setDirection(way.clone().normalize());
    this.arrow.setLength(Math.max(length, 1e-6), 0.2 * length, 0.1 * length);
    this.page.stage.draw();
  }
  async release(x, y) {
    if (!this.held) return;
    const {place} = this.held, moved = Math.hypot(x - this.held.x, y - this.held.y) > 4;
    const way = this.way(x, y).multiplyScalar(this.page.stage.size).toArray();
    this.held = null;
    if (moved) await this.pull(this.page.id_of(place), way);
    else this.let_go();
  }
  // The arrow of a pull stays until it is in force.
  let_go() {
    this.held = null;
    const {stage} = this.page;
    for (const part of [this.ball, this.arrow]) if (part) stage.scene.remove(part);
    this.ball?.geometry.dispose(), this.ball?.material.dispose(), this.arrow?.dispose();
    this.ball = this.arrow = null;
    stage?.draw();
  }
  end() {
    if (by_id("pull").checked) by_id("pull").click();
  }
}
