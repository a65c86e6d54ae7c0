// The worker: trains in WebAssembly in slices, so that a newer request stops an older one within a few milliseconds.

const SLICE = 10; // milliseconds of training between two checks for messages
const FIRST_REPORT = 100; // milliseconds of training before a result is sent: drawing one would delay a run that takes no longer
const REPORT_EVERY = 45; // milliseconds between two results while training
const EPISODE_EVERY = 250; // milliseconds between two greedy episodes while training

let source = null; // the bytes of the module, compressed by gzip, or its address
let version = null; // the page's version, which the module's must equal
let wasm = null; // the exports of the module
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

async function load() {
  const packed = () => new Response(new Blob([source]).stream().pipeThrough(new DecompressionStream("gzip")));
  const module = await (typeof source === "string" ? await fetch(source) : packed()).arrayBuffer();
  const { instance } = await WebAssembly.instantiate(module);
  wasm = instance.exports;
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

/** Calls the module. Throws an Error if it rejects the request. */
function call(request) {
  const text = new TextEncoder().encode(JSON.stringify(request));
  const address = wasm.request(text.length);
  new Uint8Array(wasm.memory.buffer, address, text.length).set(text);
  const response = wasm.call();
  const bytes = new Uint8Array(wasm.memory.buffer, response, wasm.response_length());
  const answer = JSON.parse(new TextDecoder().decode(bytes));
  if (answer.error !== undefined) throw new Error(answer.error);
  return answer;
}

const TYPES = { f64: Float64Array, i32: Int32Array, u8: Uint8Array };

/** Copies the arrays of an answer out of the module's memory. */
function arraysOf(answer) {
  const copied = {};
  for (const [name, [type, address, length]] of Object.entries(answer.arrays ?? {})) {
    copied[name] = new TYPES[type](wasm.memory.buffer, address, length).slice();
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
  call({ call: "start", environment, settings, seeds, ...(map ? { map } : {}), ...(inspect ? { inspect } : {}) });
  const now = performance.now();
  run = {
    id, seeds, episodes: settings.episodes, goal: request.run === false ? 0 : Infinity,
    state: request.run === false ? "paused" : "training", work: 20000, seconds: 0, begun: now, reported: now,
    nextReport: now + FIRST_REPORT, episodeReported: -Infinity, bestSent: false, inspected: null,
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

function report() {
  const now = performance.now();
  const last = run.state !== "training";
  const withEpisode = last || now - run.episodeReported > EPISODE_EVERY;
  // Computing the best known values of MountainCar takes as long as a run, once.
  const withBest = !run.bestSent && (last || now - run.begun > EPISODE_EVERY);
  const answer = call({ call: "report", returns: true, map: true, episode: withEpisode, best: withBest });
  const arrays = arraysOf(answer);
  run.reported = performance.now();
  run.nextReport = run.reported + REPORT_EVERY;
  if (withEpisode) run.episodeReported = run.reported;
  run.bestSent ||= withBest;
  const { returns, lengths, visits, greedy, values, xEdges = null, yEdges = null } = arrays;
  send({
    type: "result", id: run.id, state: run.state, episodes: run.episodes, done: answer.done, seeds: run.seeds,
    returns, lengths, seconds: run.seconds,
    map: { columns: answer.columns, rows: answer.rows, xEdges, yEdges, visits, greedy, values },
    best: answer.best ? { ...answer.best, values: arrays.bestValues, greedy: arrays.bestGreedy } : null,
    hasBest: withBest,
    episode: answer.episode
      ? { ...answer.episode, observations: arrays.observations, actions: arrays.episodeActions, cells: arrays.episodeCells }
      : null,
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
        advance();
        if (run.state !== "training" || performance.now() > run.nextReport) report();
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
    if (unit === "step") {
      for (let step = 0; step < count; step++) call({ call: "step" });
      const { state, done } = call({ call: "advance", work: 0 });
      run.state = state === "training" ? "paused" : state;
      run.goal = done;
      report();
    } else {
      const { done } = call({ call: "advance", work: 0 });
      Object.assign(run, { goal: done + count, state: "training" });
    }
  },
  run() {
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
  work();
};
