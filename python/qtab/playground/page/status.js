// The state of training in words.

import { count, counted, number } from "./format.js";

/** The progress of training. */
export function statusText({ state, done, episodes, seconds, current, seeds }) {
  const many = seeds.length > 1 ? `, ${seeds.length} seeds` : "";
  if (state === "training") return `Training: ${count(done)} of ${counted(episodes, "episode")}${many}.`;
  if (state === "paused") {
    const inside = current && current.step > 0 ? `, in step ${count(current.step)} of the next` : "";
    return done || inside
      ? `Paused after ${count(done)} of ${counted(episodes, "episode")}${many}${inside}.`
      : `Untrained: no episode of ${count(episodes)} is finished yet. Step shows a single step, Episode a whole episode.`;
  }
  if (state === "diverged") return `Stopped after ${counted(done, "episode")}${many}.`;
  return `Finished: ${counted(episodes, "episode")}${many} in ${duration(seconds)}.`;
}

export const DIVERGED =
  "The action values have diverged: they are no longer finite numbers. A smaller learning rate α helps.";

/** A result for screen readers: its progress, and its returns. */
export function spokenResult(result, summary, marks) {
  const compared = marks.map(({ name, value }) => `${name} ${number(value)}`).join(", ");
  return `${statusText(result)} ${summary}${compared ? ` To compare: ${compared}.` : ""}`;
}

function duration(seconds) {
  return seconds < 1 ? `${Math.round(seconds * 1000)} ms` : `${number(seconds, 2)} s`;
}
