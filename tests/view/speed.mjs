// SPDX-License-Identifier: MIT
// What the page of a run that is over takes, in headless Chromium. docs/view_table starts it.
// usage: node speed.mjs ADDRESS CHROMIUM STUDY_WEB: prints JSON.
import {launch, open} from "./browser.mjs";

const [address, chromium, study_web] = process.argv.slice(2);
const kTurns = 16000, kLearns = 10000;  // ms of turning, of which the page first finds the part that it can show

const browser = await launch(chromium, study_web);
try {
  const {page} = await open(browser, address, 1280, 900);
  page.setDefaultTimeout(600000);
  await page.waitForFunction(() => cuboct.page.frame >= 0 && !document.getElementById("legend").hidden);
  const [bytes, shown] = await page.evaluate(async () => {
    const {source} = cuboct, block = source.block.bind(source), begin = performance.now();
    let bytes = 0;
    source.block = async (...which) => {
      const all = await block(...which);
      bytes += all.byteLength;
      return all;
    };
    await cuboct.page.show(1);
    cuboct.page.stage.draw_now();
    return [bytes, performance.now() - begin];
  });
  const turned = await page.evaluate(async ([turns, learns]) => {
    const {stage} = cuboct.page, gl = stage.renderer.getContext(), pixel = new Uint8Array(4);
    const rest = () => {
      const begin = performance.now();
      stage.draw_now();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);  // waits until all is drawn
      return performance.now() - begin;
    };
    rest();
    const still = [rest(), rest(), rest()].sort((a, b) => a - b)[1];
    let drawn = [];
    const draw_now = stage.draw_now.bind(stage);
    stage.draw_now = () => { draw_now(); drawn.push(performance.now()); };
    stage.held = true;
    stage.move();
    const begin = performance.now();
    await new Promise((done) => {
      const turn = () => {
        const {x, y} = stage.camera.position, angle = 0.02;
        stage.camera.position.x = Math.cos(angle) * x - Math.sin(angle) * y;
        stage.camera.position.y = Math.sin(angle) * x + Math.cos(angle) * y;
        stage.controls.update();
        if (performance.now() - begin < turns) requestAnimationFrame(turn); else done();
      };
      turn();
    });
    const {sharp} = stage, particles = stage.drawn_particles;
    stage.held = false;
    drawn = drawn.filter((time) => time > begin + learns);
    return {still, sharp, particles, rate: (1000 * (drawn.length - 1)) / (drawn.at(-1) - drawn[0])};
  }, [kTurns, kLearns]);
  const renderer = await page.evaluate(() => {
    const gl = cuboct.page.stage.renderer.getContext();
    return gl.getParameter(gl.getExtension("WEBGL_debug_renderer_info").UNMASKED_RENDERER_WEBGL);
  });
  console.log(JSON.stringify({bytes, shown, renderer, ...turned}));
} finally {
  await browser.close();
}
