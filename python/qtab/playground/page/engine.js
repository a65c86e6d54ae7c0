// The page's interface to the engine: starts the worker, keeps only the newest request, and completes settings.

const DATA = globalThis.QTAB_PLAYGROUND ?? {};

/** The environments and settings from Python's definitions.py. */
export const definitions = DATA.definitions ?? null;

/** All settings that apply with `given` in an environment, with defaults for those that are not given. */
export function complete(environment, given) {
  const known = definitions.environments[environment];
  const settings = {};
  for (const [name, { default: fallback, applies }] of Object.entries(definitions.settings)) {
    if (applies && !applies.values.includes(settings[applies.choice])) continue;
    const natural = { max_episode_steps: known.max_episode_steps, discretizer: known.discretizers[0] }[name];
    const value = given[name] ?? known.options[name] ?? natural ?? fallback;
    if (value === null || (Array.isArray(value) && value.length === 0)) continue;
    settings[name] = value;
  }
  return settings;
}

/** The environment in the form that the WebAssembly module expects. */
function environmentOf({ id, ...painted }) {
  const known = definitions.environments[id];
  if (!known) throw new Error(`unknown environment '${id}'`);
  if (known.drawing !== "grid") return { kind: known.drawing, layout: known.layout, ...known.env_kwargs };
  return { kind: "grid", ...(painted.layout ? painted : Object.values(known.grids)[0]) };
}

function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

function startWorker() {
  if (!DATA.worker) return new Worker(new URL("worker.js", document.baseURI));
  // A page from a file can start workers only from blobs.
  return new Worker(URL.createObjectURL(new Blob([DATA.worker], { type: "text/javascript" })));
}

export class Engine {
  #worker = startWorker();
  #id = 0;
  #best = null;
  #inspection = null;
  #inspected = null;
  #tables = new Map(); // the callbacks waiting for each table
  #token = 0;
  #onMessage;

  constructor({ onMessage }) {
    this.#onMessage = onMessage;
    this.#worker.onmessage = ({ data }) => this.#receive(data);
    this.#worker.onerror = (event) => onMessage({ type: "error", id: this.#id, message: event.message });
    if (DATA.wasm) {
      const bytes = bytesOf(DATA.wasm);
      this.#worker.postMessage({ type: "load", bytes, version: definitions.version }, [bytes.buffer]);
    } else {
      this.#worker.postMessage({ type: "load", url: new URL("qtab.wasm", document.baseURI).href, version: definitions.version });
    }
  }

  /** Starts a new training; an older request is dropped. Returns the id of its messages. */
  start(request) {
    this.#best = this.#inspection = null;
    this.#id += 1;
    try {
      const environment = environmentOf(request.environment);
      this.#post({ type: "start", id: this.#id, request: { ...request, environment }, inspected: this.#inspected });
    } catch (error) {
      const [id, { message }] = [this.#id, error];
      queueMicrotask(() => id === this.#id && this.#onMessage({ type: "error", id, message }));
    }
    return this.#id;
  }

  /** Trains for some more steps or episodes, then waits. */
  advance(unit, count = 1) {
    this.#post({ type: "advance", unit, count });
  }

  run() {
    this.#post({ type: "run" });
  }

  stop() {
    this.#post({ type: "stop" });
  }

  /** Requests the last updates of a cell, now and after each result; null stops this. */
  inspect(cell) {
    this.#inspected = cell;
    if (cell === null) this.#inspection = null;
    this.#post({ type: "inspect", cell });
  }

  /** Sets how many steps of each agent a second takes; Infinity trains as fast as possible. */
  setPace(steps) {
    this.#post({ type: "pace", steps });
  }

  /** Requests the values after some episodes, null for none; those at `places` on the way are kept for later requests. */
  lookBack(episodes, places) {
    this.#post({ type: "past", episodes, places });
  }

  /** The action values of a run, in the layout of qtab's q_table: (tables, rows, actions) in one array. */
  table(seed = 0) {
    const token = (this.#token += 1);
    this.#post({ type: "table", token, seed });
    return new Promise((resolve) => this.#tables.set(token, resolve));
  }

  #post(message) {
    this.#worker.postMessage(message);
  }

  #receive(message) {
    if (message.type === "table") {
      this.#tables.get(message.token)?.(message.table);
      this.#tables.delete(message.token);
      return;
    }
    if (message.id !== this.#id) return;
    if (message.type === "inspection") {
      if (message.cell !== this.#inspected) return;
      this.#inspection = message;
    }
    if (message.type === "result") {
      const { hasBest, ...result } = message;
      if (hasBest) this.#best = result.best;
      this.#onMessage({ ...result, best: this.#best, inspection: this.#inspection });
      return;
    }
    this.#onMessage(message);
  }
}
