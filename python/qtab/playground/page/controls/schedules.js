// The learning rate and ε of a run that lets them fall, in the words of qtab's plots.

import { number } from "../format.js";

/**
 * What a rate falls to, as text to follow its value: "→ 0.1" for its value in the last episode, "/ visits" for one that
 * is divided by the number of visits; "" for one that does not fall. `name`: "learning_rate" or "epsilon".
 */
export function fallingText(settings, name) {
  const start = settings[name];
  const [schedule, lowest = 0, factor, warmUp = 0] = [`${name}_schedule`, `min_${name}`, `${name}_decay`, `${name}_warm_up`].map((each) => settings[each]);
  if (schedule === "visits") return lowest > 0 ? `/ visits, ≥ ${number(lowest)}` : "/ visits";
  const last = {
    linear: lowest,
    exponential: Math.max(start * factor ** (settings.episodes - 1 - warmUp), lowest),
  }[schedule] ?? start;
  return last < start ? `→ ${number(last, 3)}` : "";
}
