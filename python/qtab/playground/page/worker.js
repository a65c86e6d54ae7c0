// The worker: trains in WebAssembly in slices, so that a newer request stops an older one within a few milliseconds.

const SLICE = 10; // milliseconds of training between two checks for messages
const FIRST_REPORT = 100; // milliseconds of training before a result is sent: drawing one would delay a run that takes no longer
const REPORT_EVERY = 45; // milliseconds between two results while training
const EPISODE_EVERY = 250; // milliseconds between two greedy episodes while training

let source = null; // the bytes of the module, compressed by gzip, or its address
let version = null; // the page's version, which the module's must equal
let wasm = null; // the exports of the module
let compiled = null; // the module, for another instance of it
let past = null; // a second training of the run's first agent, whose earlier values a reader looks back at
let pace = Infinity; // steps of each agent in a second
let wake = null; // ends a wait
let pending = null; // the newest request, not yet begun
let run = null; // the current run
let scheduled = false;
const channel = new MessageChannel();

/** Lets waiting messages be handled first. */
function pause() {
  return new Promise((resolve) => {
    channel.port1.onmessage = resolve;
    channel.port2.postMessage(null);
  });
}

/** Waits for some milliseconds, or until a message comes. */
function wait(milliseconds) {
  return new Promise((resolve) => {
    wake = resolve;
    setTimeout(resolve, milliseconds);
  });
}

async function load() {
  const packed = () => new Response(new Blob([source]).stream().pipeThrough(new DecompressionStream("gzip")));
  const module = await (typeof source === "string" ? await fetch(source) : packed()).arrayBuffer();
  const { instance, module: ready } = await WebAssembly.instantiate(module);
  [wasm, compiled, past] = [instance.exports, ready, null];
  let built = "of an earlier version";
  try {
    built = call({ call: "version" }).version;
  } catch {
    // It does not support the call.
  }
  if (built === version) return;
  wasm = null;
  throw new Error(`qtab.wasm is ${built}, and the page ${version}: rebuild it with python rust/web/build_backend.py`);
}

/** Calls an instance of the module. Throws an Error if it rejects the request. */
function call(request, instance = wasm) {
  const text = new TextEncoder().encode(JSON.stringify(request));
  const address = instance.request(text.length);
  new Uint8Array(instance.memory.buffer, address, text.length).set(text);
  const response = instance.call();
  const bytes = new Uint8Array(instance.memory.buffer, response, instance.response_length());
  const answer = JSON.parse(new TextDecoder().decode(bytes));
  if (answer.error !== undefined) throw new Error(answer.error);
  return answer;
}

const TYPES = { f64: Float64Array, i32: Int32Array, u8: Uint8Array };

/** Copies the arrays of an answer out of the memory of an instance. */
function arraysOf(answer, instance = wasm) {
  const copied = {};
  for (const [name, [type, address, length]] of Object.entries(answer.arrays ?? {})) {
    copied[name] = new TYPES[type](instance.memory.buffer, address, length).slice();
  }
  return copied;
}

function send(message) {
  const buffers = [];
  const collect = (value) => {
    if (ArrayBuffer.isView(value)) buffers.push(value.buffer);
    else if (value && typeof value === "object") Object.values(value).forEach(collect);
  };
  collect(message);
  postMessage(message, buffers);
}

/** Begins the newest request. */
function begin({ id, request, inspected, later }) {
  run = null;
  const { environment, settings, seeds, map, inspect } = request;
  const start = { call: "start", environment, settings, ...(map ? { map } : {}) };
  call({ ...start, seeds, ...(inspect ? { inspect } : {}) });
  const now = performance.now();
  run = {
    id, start, stepped: now, wanted: null, places: [], seeds, episodes: settings.episodes, goal: request.run === false ? 0 : Infinity,
    state: request.run === false ? "paused" : "training", work: 20000, seconds: 0, begun: now, reported: now,
    nextReport: now + FIRST_REPORT, episodeReported: -Infinity, showsBest: request.best !== false, bestSent: false, inspected: null,
  };
  if (run.state === "paused") report();
  if (inspected !== null) run.inspected = inspected;
  for (const message of later) handlers[message.type](message);
}

/** Trains for a slice. */
function advance() {
  const begun = performance.now();
  let elapsed = 0;
  let answer;
  do {
    answer = call({ call: "advance", work: run.work, ...(run.goal === Infinity ? {} : { episodes: run.goal }) });
    const taken = performance.now() - begun - elapsed;
    elapsed += taken;
    // Aim for calls of 2 to 5 milliseconds.
    if (taken < 2) run.work = Math.min(run.work * 2, 2_000_000);
    else if (taken > 5) run.work = Math.max(run.work >> 1, 500);
  } while (answer.state === "training" && answer.done < run.goal && elapsed < SLICE);
  run.seconds += elapsed / 1000;
  if (answer.state !== "training") run.state = answer.state;
  else if (answer.done >= run.goal) run.state = "paused";
}

function mapOf({ columns, rows }, { visits, greedy, values, xEdges = null, yEdges = null }) {
  return { columns, rows, xEdges, yEdges, visits, greedy, values };
}

function episodeOf({ episode }, { observations, episodeActions: actions, episodeCells: cells }) {
  return episode ? { ...episode, observations, actions, cells } : null;
}

/**
 * Sends the values after some episodes of the run's first agent, which is trained once more for this. The values at every
 * place of the slider on the way are kept. Returns early if a newer message arrives.
 */
async function lookBack() {
  const { id, start, seeds, wanted } = run;
  const isNew = past?.id !== id;
  if (isNew || (past.done > wanted && !past.kept.has(wanted))) {
    const instance = past?.instance ?? (await WebAssembly.instantiate(compiled)).exports;
    call({ ...start, seeds: seeds.slice(0, 1) }, instance);
    past = { id, instance, done: 0, state: "training", kept: isNew ? new Map() : past.kept };
  }
  const { instance, kept } = past;
  const keep = () => {
    if (kept.has(past.done)) return;
    const answer = call({ call: "report", map: true, episode: true }, instance);
    const arrays = arraysOf(answer, instance);
    kept.set(past.done, { map: mapOf(answer, arrays), episode: episodeOf(answer, arrays) });
  };
  keep();
  while (!kept.has(wanted) && past.state === "training") {
    const begun = performance.now();
    const goal = Math.min(run.places.find((place) => place > past.done) ?? wanted, wanted);
    do Object.assign(past, call({ call: "advance", work: 20000, episodes: goal }, instance));
    while (past.state === "training" && past.done < goal && performance.now() - begun < SLICE);
    if (past.done >= goal || past.state !== "training") keep();
    await pause();
    if (pending || run?.id !== id || run.wanted !== wanted) return;
  }
  if (run.wanted !== wanted) return;
  run.wanted = null;
  const found = kept.get(wanted) ?? kept.get(past.done);
  postMessage({ type: "past", id, episodes: wanted, ...found });
}

/** Takes the steps that are due at the chosen pace, or waits for the next one. */
async function walk() {
  const left = run.stepped + 1000 / pace - performance.now();
  if (left > 0) {
    await wait(Math.min(left, 1000));
    return;
  }
  const begun = performance.now();
  // What cannot be caught up with in a slice is left out: the pace is then that of the machine.
  const due = Math.floor(((begun - run.stepped) / 1000) * pace);
  let steps = 0;
  let answer;
  do {
    answer = call({ call: "step" });
    steps += 1;
  } while (steps < due && answer.state === "training" && answer.done < run.goal && performance.now() - begun < SLICE);
  run.stepped = steps < due ? begun : run.stepped + (1000 * steps) / pace;
  run.seconds += (performance.now() - begun) / 1000;
  if (answer.state !== "training") run.state = answer.state;
  else if (answer.done >= run.goal) run.state = "paused";
}

function report() {
  const now = performance.now();
  const last = run.state !== "training";
  const withEpisode = last || now - run.episodeReported > EPISODE_EVERY;
  // Computing the best known values of MountainCar takes as long as a run, once.
  const withBest = run.showsBest && !run.bestSent && (last || now - run.begun > EPISODE_EVERY);
  const answer = call({ call: "report", returns: true, map: true, episode: withEpisode, best: withBest });
  const arrays = arraysOf(answer);
  run.reported = performance.now();
  run.nextReport = run.reported + REPORT_EVERY;
  if (withEpisode) run.episodeReported = run.reported;
  run.bestSent ||= withBest;
  send({
    type: "result", id: run.id, state: run.state, episodes: run.episodes, done: answer.done, seeds: run.seeds,
    returns: arrays.returns, lengths: arrays.lengths, seconds: run.seconds, pace,
    map: mapOf(answer, arrays),
    best: answer.best ? { ...answer.best, values: arrays.bestValues, greedy: arrays.bestGreedy } : null,
    hasBest: withBest,
    episode: episodeOf(answer, arrays),
    current: answer.current ? { ...answer.current, observation: arrays.observation } : null,
  });
}

/** Finds the last updates of the inspected cell, unless a newer message arrives first. */
async function inspect() {
  const { id, inspected: cell } = run;
  let answer;
  for (;;) {
    const begun = performance.now();
    do answer = call({ call: "inspect", cell, work: 20000 });
    while (answer.state === "replaying" && performance.now() - begun < SLICE);
    if (answer.state !== "replaying") break;
    await pause();
    if (pending || run?.id !== id || run.inspected !== cell) return;
  }
  const { actionValues, visits, observation } = arraysOf(answer);
  const updates = answer.updates.map((update) => ({ ...update, discount: answer.discount }));
  send({ type: "inspection", id, cell, observation, actionValues, visits, updates });
  if (run?.id === id) run.inspectedAt = performance.now();
}

function fail(id, error) {
  send({ type: "error", id, message: error.message });
}

/** Works until nothing is left to do. */
async function work() {
  if (scheduled) return;
  scheduled = true;
  for (;;) {
    await pause();
    let id = pending?.id ?? run?.id;
    try {
      if (!wasm) await load();
      if (pending) {
        const request = pending;
        pending = null;
        begin(request);
      } else if (run?.state === "training") {
        if (pace === Infinity) advance();
        else await walk();
        if (pending || !run) continue;
        if (run.state !== "training" || performance.now() > run.nextReport) report();
      } else if (run && run.wanted !== null) {
        await lookBack();
      } else if (run && run.inspected !== null && !(run.inspectedAt >= run.reported)) {
        await inspect();
      } else {
        break;
      }
    } catch (error) {
      run = null;
      if (!wasm) {
        // Without the module no request can be answered, nor the one that came while it was loaded.
        id = pending?.id ?? id;
        pending = null;
      }
      // After a fault the module cannot continue.
      if (error instanceof WebAssembly.RuntimeError) wasm = null;
      fail(id, error instanceof WebAssembly.RuntimeError ? new Error(`training stopped: ${error.message}`) : error);
    }
  }
  scheduled = false;
}

const handlers = {
  load(message) {
    source = message.bytes ?? message.url;
    version = message.version;
  },
  start(message) {
    pending = { ...message, later: [] };
  },
  advance({ unit, count }) {
    if (!run || run.state === "finished" || run.state === "diverged") return;
    run.wanted = null;
    if (unit === "step") {
      for (let step = 0; step < count; step++) call({ call: "step" });
      const { state, done } = call({ call: "advance", work: 0 });
      run.state = state === "training" ? "paused" : state;
      run.goal = done;
      report();
    } else {
      const { done } = call({ call: "advance", work: 0 });
      Object.assign(run, { goal: done + count, state: "training", stepped: performance.now() });
    }
  },
  pace({ steps }) {
    pace = steps;
    if (run) run.stepped = performance.now();
  },
  /** Looks back; null ends this. */
  past({ episodes, places }) {
    if (run) Object.assign(run, { wanted: episodes, places });
  },
  run() {
    if (run) Object.assign(run, { stepped: performance.now(), wanted: null });
    if (run?.state === "paused") Object.assign(run, { goal: Infinity, state: "training" });
  },
  stop() {
    if (run?.state !== "training") return;
    run.state = "paused";
    report();
  },
  inspect({ cell }) {
    if (run) Object.assign(run, { inspected: cell, inspectedAt: -Infinity });
    if (pending) pending.inspected = cell;
  },
  table({ token, seed }) {
    let table = null;
    try {
      table = run && arraysOf(call({ call: "table", seed })).table;
    } finally {
      send({ type: "table", token, table });
    }
  },
};

// These act on the run that was requested last, even if it has not begun.
const ACTS_ON_RUN = ["advance", "run", "stop"];

onmessage = ({ data }) => {
  try {
    if (pending && ACTS_ON_RUN.includes(data.type)) pending.later.push(data);
    else handlers[data.type]?.(data);
  } catch (error) {
    fail(run?.id, error);
  }
  wake?.();
  work();
};
