// SPDX-License-Identifier: MIT
// How the axes lie in the picture, in its corner.

const kLong = 26, kMiddle = 40;

export class Axes {
  constructor(picture) {
    this.arms = ["x", "y", "z"].map((axis) => {
      const arm = document.createElementNS("http://www.w3.org/2000/svg", "line"), name = document.createElementNS("http://www.w3.org/2000/svg", "text");
      arm.setAttribute("x1", kMiddle), arm.setAttribute("y1", kMiddle);
      name.textContent = axis;
      picture.append(arm, name);
      return {arm, name};
    });
  }
  // `seen`: the camera's matrix from the scene to what it sees, column by column.
  turn(seen) {
    this.arms.forEach(({arm, name}, k) => {
      const x = seen.elements[4 * k], y = -seen.elements[4 * k + 1];
      arm.setAttribute("x2", kMiddle + kLong * x), arm.setAttribute("y2", kMiddle + kLong * y);
      name.setAttribute("x", kMiddle + 1.3 * kLong * x), name.setAttribute("y", kMiddle + 1.3 * kLong * y + 4);
    });
  }
}
