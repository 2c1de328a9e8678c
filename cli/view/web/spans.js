// SPDX-License-Identifier: MIT
// The phases of one step as the run recorded them, and who was behind whom. Cycles count from the first of the step's first node.

// Words of a node in the block of nodes: its lowest cell, its cells, faces that lead to another device, its neighbours.
export const kNodeWords = 11, kNeighbours = 5;

export class Spans {
  // `words`: the step's block; `nodes`: that of the nodes; `machine`: of the story.
  constructor(words, nodes, machine) {
    this.base = words[0] + words[1] * 2 ** 32;
    this.words = words;
    this.nodes = nodes;
    this.axes = machine.axes;
    this.phases = machine.phases.length;
    this.count = machine.nodes;
    this.length = 0;
    for (let at = 3; at < words.length; at += 2) this.length = Math.max(this.length, words[at]);
  }
  start(node, phase) { return this.words[2 + 2 * (node * this.phases + phase)]; }
  end(node, phase) { return this.words[3 + 2 * (node * this.phases + phase)]; }  // the first cycle behind it
  cycles(node, phase) { return this.end(node, phase) - this.start(node, phase); }
  begin_of(node) {
    let first = Infinity;
    for (let p = 0; p < this.phases; ++p) first = Math.min(first, this.start(node, p));
    return first;
  }
  end_of(node) {
    let last = 0;
    for (let p = 0; p < this.phases; ++p) last = Math.max(last, this.end(node, p));
    return last;
  }
  // The phase of a node in a cycle: of two that run beside one another the earlier. -1: before its step; `phases`: behind it.
  phase_at(node, cycle) {
    for (let p = 0; p < this.phases; ++p) if (this.start(node, p) <= cycle && cycle < this.end(node, p)) return p;
    return cycle < this.begin_of(node) ? -1 : this.phases;
  }
  // The neighbours that begin an exchange or a migration later than the node. It cannot end the phase before they have begun:
  // what it waits for comes in theirs. {node, face, until}.
  late(node, phase) {
    const axis = this.axes[phase], found = [];
    if (axis < 0 || this.cycles(node, phase) === 0) return found;
    for (const face of [2 * axis, 2 * axis + 1]) {
      const other = this.nodes[node * kNodeWords + kNeighbours + face];
      if (other < 0 || other === node || this.start(other, phase) <= this.start(node, phase)) continue;
      found.push({node: other, face, until: Math.min(this.start(other, phase), this.end(node, phase))});
    }
    return found;
  }
  // Cycles of a phase before the last of its neighbours has begun it.
  wait(node, phase) {
    return Math.max(0, ...this.late(node, phase).map(({until}) => until - this.start(node, phase)));
  }
  wait_of(node) {
    let sum = 0;
    for (let p = 0; p < this.phases; ++p) if (this.axes[p] >= 0) sum += this.wait(node, p);
    return sum;
  }
}
