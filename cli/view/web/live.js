// SPDX-License-Identifier: MIT
// A run while it goes: what is new is asked for again and again, and the newest frame shown. A page that is slow skips frames.
import {grow} from "./curves.js";
import {by_id} from "./format.js";
import {settle} from "./steer.js";

const kEvery = 200;   // ms between questions
const kAway = 1000;   // ms, where the server did not answer

const kStates = {waiting: "waiting for the run's first frame", running: "running", paused: "paused",
  lost: "no frames come; the run's directory is still in use", ended: "the run is over", gone: "the server is gone; what was seen stays"};

export function follow(page, source) {
  const {story} = page;
  by_id("live").hidden = false;
  by_id("follow").checked = true;
  for (const word of ["pause", "continue", "step", "end"])
    by_id(word).addEventListener("click", () => page.attempt(async () => {
      if (word === "end" && !window.confirm("End the run after the step at hand? What it has done is kept.")) return;
      await source.command(word);
    }));
  by_id("time").addEventListener("input", () => { by_id("follow").checked = false; });

  const tell = (state) => {
    by_id("state").textContent = kStates[state] || state;
    by_id("live").dataset.state = state;
    by_id("pause").disabled = state !== "running";
    by_id("continue").disabled = by_id("step").disabled = state !== "paused";
    by_id("end").disabled = state === "lost" || state === "ended" || state === "gone" || !story.may_end;
  };
  const ask = async () => {
    let wait = kEvery;
    try {
      const news = await source.news(story.frames.length, story.lines.length);
      settle(news.frames, story.head.dt);
      story.frames.push(...news.frames);
      if (news.steered) page.steer.tell(news.steered);
      story.lines.push(...news.lines);
      if (news.lines.length) page.tell_lists();
      if (news.frames.length) {
        by_id("lead").textContent = page.lead();
        grow(story.curves, news.frames);
        page.tell_curves();
      }
      by_id("time").max = String(Math.max(0, story.frames.length - 1));
      tell(news.state);
      if (news.frames.length && by_id("follow").checked && !page.playing) {
        // On a full disk a newer frame may have taken its place since: the next news has that.
        await page.show(story.frames.length - 1).catch((error) => { if (error.status !== 404) throw error; });
      }
      // The whole run, with its curves and warnings, is another story.
      if (news.state === "ended" && news.whole) return window.location.reload();
      if (news.state === "ended") wait = kAway;  // its directory may still be on its way
    } catch {
      tell("gone");
      wait = kAway;
    }
    setTimeout(ask, wait);
  };
  tell(story.state || "waiting");
  ask();
}
