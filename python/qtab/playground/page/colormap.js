// Color maps for numbers: viridis for values, as in the package's pictures, and shades of blue for visits.

const VIRIDIS = ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"];
const BLUES = ["eef3fa", "d3e0f0", "b0c9e6", "86abd8", "5c8cc7", "3a6cb0", "275091", "193870"];
const DARK_BLUES = ["1d2633", "223650", "284a75", "31619b", "447cbd", "6899d3", "97bbe6", "d0e2f7"];

const channels = (hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16));
const MAPS = {
  values: VIRIDIS.map(channels),
  visits: BLUES.map(channels),
  darkVisits: DARK_BLUES.map(channels),
};

/** The red, green and blue of a number from 0 to 1. */
export function shade(name, share) {
  const stops = MAPS[name];
  const place = Math.min(Math.max(Number.isFinite(share) ? share : 0, 0), 1) * (stops.length - 1);
  const index = Math.min(Math.floor(place), stops.length - 2);
  return stops[index].map((low, channel) => Math.round(low + (stops[index + 1][channel] - low) * (place - index)));
}

/** A color in the form that canvases use. */
export function css([red, green, blue], alpha = 1) {
  return `rgba(${red}, ${green}, ${blue}, ${alpha})`;
}

/** Black or white, whichever is readable on a color. */
export function inkOn([red, green, blue]) {
  return 0.299 * red + 0.587 * green + 0.114 * blue > 140 ? "#10151d" : "#ffffff";
}

/** The gradient of a color map, for the bar of a legend. */
export function gradient(name) {
  const stops = Array.from({ length: 11 }, (_, index) => css(shade(name, index / 10)));
  return `linear-gradient(to right, ${stops.join(", ")})`;
}
