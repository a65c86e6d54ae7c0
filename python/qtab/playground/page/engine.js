// The engine as the page sees it: it starts the worker, keeps the newest request only, and completes settings.

const DATA = globalThis.QTAB_PLAYGROUND ?? {};

/** What Python's definitions.py says of environments and settings. */
export const definitions = DATA.definitions ?? null;

/** All settings that apply beside `given` in an environment, with the defaults of those that are not given. */
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

/** Why two of the settings exclude each other; null if none do. */
export function conflict(settings) {
  for (const { setting, value, unless, reason } of definitions.rules) {
    const [other, chosen] = Object.entries(unless)[0];
    if (settings[setting] === value && settings[other] === chosen) return { setting, reason };
  }
  return null;
}

/** The environment as the WebAssembly module takes it. */
function environmentOf({ id, ...painted }) {
  const known = definitions.environments[id];
  if (!known) throw new Error(`unknown environment '${id}'`);
  if (known.table) return { kind: "table", table: known.table, columns: known.layout[0].length };
  if (known.drawing !== "grid") return { kind: known.drawing };
  return { kind: "grid", ...(painted.layout ? painted : Object.values(known.grids)[0]) };
}

function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

function startWorker() {
  if (!DATA.worker) return new Worker(new URL("worker.js", document.baseURI));
  // A page from a file may start workers from blobs only.
  return new Worker(URL.createObjectURL(new Blob([DATA.worker], { type: "text/javascript" })));
}

export class Engine {
  #worker = startWorker();
  #id = 0;
  #request = null;
  #best = null;
  #inspection = null;
  #inspected = null;
  #tables = new Map(); // who waits for which table
  #token = 0;
  #onMessage;

  constructor({ onMessage }) {
    this.#onMessage = onMessage;
    this.#worker.onmessage = ({ data }) => this.#receive(data);
    this.#worker.onerror = (event) => onMessage({ type: "error", id: this.#id, message: event.message, setting: null });
    if (DATA.wasm) {
      const bytes = bytesOf(DATA.wasm);
      this.#worker.postMessage({ type: "load", bytes, version: definitions.version }, [bytes.buffer]);
    } else {
      this.#worker.postMessage({ type: "load", url: new URL("qtab.wasm", document.baseURI).href, version: definitions.version });
    }
  }

  /** Trains anew; an older request is given up. Returns the id that its messages carry. */
  start(request) {
    this.#request = request;
    this.#best = this.#inspection = null;
    this.#id += 1;
    try {
      const environment = environmentOf(request.environment);
      this.#post({ type: "start", id: this.#id, request: { ...request, environment }, inspected: this.#inspected });
    } catch (error) {
      const [id, { message }] = [this.#id, error];
      queueMicrotask(() => id === this.#id && this.#onMessage({ type: "error", id, message, setting: null }));
    }
    return this.#id;
  }

  /** Goes back to before the first step and waits there. */
  reset() {
    return this.#request && this.start({ ...this.#request, run: false });
  }

  /** Trains for some steps or episodes more, then waits. */
  advance(unit, count = 1) {
    this.#post({ type: "advance", unit, count });
  }

  run() {
    this.#post({ type: "run" });
  }

  stop() {
    this.#post({ type: "stop" });
  }

  /** Asks for the last updates of a cell, now and after each result; null ends it. */
  inspect(cell) {
    this.#inspected = cell;
    if (cell === null) this.#inspection = null;
    this.#post({ type: "inspect", cell });
  }

  /** The action values of a run, as qtab's q_table has them: (tables, rows, actions) in one array. */
  table(seed = 0) {
    const token = (this.#token += 1);
    this.#post({ type: "table", token, seed });
    return new Promise((resolve) => this.#tables.set(token, resolve));
  }

  close() {
    this.#worker.terminate();
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
    if (message.type !== "ready" && message.id !== this.#id) return;
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
