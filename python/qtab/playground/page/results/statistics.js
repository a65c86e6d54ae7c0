// The statistics of the learning curve: moving means, their mean over the seeds, and its interval.

/** Two-sided 95 % quantiles of Student's t distribution, by degrees of freedom; 1.96 beyond the list. */
const T_QUANTILES = [
  ...[NaN, 12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228],
  ...[2.201, 2.179, 2.16, 2.145, 2.131],
];

/** The number of episodes that a moving mean covers, for a run of `episodes` episodes. */
export function windowOf(episodes) {
  return episodes >= 1000 ? 100 : Math.min(Math.max(Math.round(episodes / 20), 5), episodes);
}

/** The number of last episodes whose mean stands below the curve: a fifth of a short run, and 100 of a long one. */
export function lastOf(episodes) {
  return Math.min(Math.max(Math.round(episodes / 5), 5), 100, episodes);
}

/** The mean of the last `width` numbers before each of the ascending ends; of fewer at the start. */
export function movingMeans(values, width, ends) {
  const sums = new Float64Array(values.length + 1);
  for (let index = 0; index < values.length; index++) sums[index + 1] = sums[index] + values[index];
  return ends.map((end) => {
    const from = Math.max(end - width, 0);
    return (sums[end] - sums[from]) / (end - from);
  });
}

/** About `points` ends of windows up to a number of episodes, always including the last one. */
export function windowEnds(episodes, points) {
  const step = Math.max(episodes / points, 1);
  const ends = [];
  for (let place = step; place < episodes; place += step) ends.push(Math.round(place));
  if (episodes > 0) ends.push(episodes);
  return ends;
}

/** The mean over the rows at each place, and the half width of its 95 % interval; NaN for a single row. */
export function meanAndInterval(rows) {
  const size = rows.length;
  const mean = rows[0].map((_, place) => rows.reduce((sum, row) => sum + row[place], 0) / size);
  const quantile = T_QUANTILES[size - 1] ?? 1.96;
  const half = mean.map((center, place) => {
    const squares = rows.reduce((sum, row) => sum + (row[place] - center) ** 2, 0);
    return quantile * Math.sqrt(squares / (size - 1) / size);
  });
  return { mean, half };
}

/** The number below which a share of the numbers lies, from an evenly spaced sample if there are many. */
export function quantile(values, share) {
  const step = Math.max(Math.floor(values.length / 2000), 1);
  const sample = [];
  for (let index = 0; index < values.length; index += step) {
    if (Number.isFinite(values[index])) sample.push(values[index]);
  }
  sample.sort((left, right) => left - right);
  return sample.length ? sample[Math.min(Math.floor(share * sample.length), sample.length - 1)] : NaN;
}
