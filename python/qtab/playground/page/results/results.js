// A result in words, and the content of its maps: colors, policies and paths, with one scale for all values.

import { make } from "../controls/elements.js";
import { isEnd } from "../drawing/map_drawing.js";
import { gradient, themeColors } from "../drawing/theme.js";
import { count, counted, number } from "../format.js";

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

/** The range of the values to show: those of the visited states on each map, and the optimal ones. */
export function valueRange(maps, best, layout) {
  let [low, high] = [Infinity, -Infinity];
  const include = (value) => {
    if (!Number.isFinite(value)) return;
    low = Math.min(low, value);
    high = Math.max(high, value);
  };
  for (const { values, visits } of maps) values.forEach((value, cell) => visits[cell] > 0 && include(value));
  best?.values.forEach((value, cell) => isEnd(layout, cell) || include(value));
  if (low > high) maps[0].values.forEach(include);
  return low > high ? [0, 1] : [low, high];
}

/** The content of a map of learned values, whose colors span a range. */
export function learnedContent(map, [low, high], frame, path) {
  const share = shareOf(map.values, low, high);
  const isUnvisited = (cell) => !(map.visits[cell] > 0);
  const visited = map.visits.reduce((sum, visits) => sum + (visits > 0), 0);
  const label = `Map of the learned values, ${describeSize(map)}: values from ${number(low)} to ${number(high)}; ${count(visited)} cells visited.`;
  return { ...frame, map, greedy: map.greedy, palette: "values", share, isUnvisited, path, label };
}

/** The content of the map of visits. */
export function visitsContent(map, frame) {
  const most = Math.round(map.visits.reduce((largest, visits) => Math.max(largest, visits), 0));
  const top = Math.log1p(most) || 1;
  // A plane has no walls: there values are NaN only if they diverged.
  const share = (cell) => (!frame.plane && isWall(map.values, cell) ? NaN : Math.log1p(map.visits[cell]) / top);
  const palette = themeColors().isDark ? "darkVisits" : "visits";
  const label = `Map of the visits, ${describeSize(map)}: at most ${count(most)} visits of a cell.`;
  return { ...frame, map, greedy: null, palette, share, isUnvisited: () => false, path: null, label, most };
}

/** The content of the map of the optimal or best known values, whose colors span a range. */
export function bestContent({ map, best }, [low, high], frame) {
  const share = shareOf(best.values, low, high);
  const label = `Map of the ${best.kind} values, in the same colors as the learned ones.`;
  return { ...frame, map, greedy: best.greedy, palette: "values", share, isUnvisited: () => false, path: null, label };
}

function isWall(values, cell) {
  return Number.isNaN(values[cell]);
}

function shareOf(values, low, high) {
  return (cell) => (isWall(values, cell) ? NaN : high > low ? (values[cell] - low) / (high - low) : 0.5);
}

function describeSize({ columns, rows }) {
  return `${rows} rows and ${columns} columns`;
}

/** Shows the color bar with its limits, and the meaning of hatched cells. */
export function showLegend(place, palette, low, high, unvisited = false) {
  const bar = make("span", { className: "bar" });
  bar.style.background = gradient(palette);
  const hatched = () => make("span", { className: "key" }, make("span", { className: "unvisited" }), "never visited");
  place.replaceChildren(low, bar, high, ...(unvisited ? [hatched()] : []));
}

/** The greedy episode as a path on a map: positions on a plane, or cells. Null ends a part of it. */
export function pathOf(episode, { plane, drawing, layout }) {
  if (!episode || drawing === "blackjack") return null;
  if (!plane) {
    const isApart = (cell, before) => drawing === "taxi" && Math.abs((cell % layout[0].length) - (before % layout[0].length)) > 1;
    return Array.from(episode.cells).flatMap((cell, step, cells) => (step && isApart(cell, cells[step - 1]) ? [null, cell] : [cell]));
  }
  const { observations, components } = episode;
  const places = [];
  for (let at = 0; at < observations.length; at += components) {
    const place = placeOn(plane, observations.subarray(at, at + components));
    if (at && hasTurned(plane, place, places.at(-1))) places.push(null);
    places.push(place);
  }
  return places;
}

/** Whether an angle has passed from π to −π, or back, between two places. */
function hasTurned({ x, y }, place, before) {
  return [x, y].some(({ is_angle }, axis) => is_angle && Math.abs(place[axis] - before[axis]) > Math.PI);
}

/** The place of an observation along an axis of a plane: a component, or the angle of a cosine and the sine after it. */
export function along({ component, is_angle }, observation) {
  return is_angle ? Math.atan2(observation[component + 1], observation[component]) : observation[component];
}

/** The place of an observation on a plane. */
export function placeOn({ x, y }, observation) {
  return [along(x, observation), along(y, observation)];
}
