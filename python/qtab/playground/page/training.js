// The run that the engine trains: the actions of the buttons, and the handling of its messages.

/** Starts, pauses and continues runs of a store's state. `request()` returns what to train. */
export class Training {
  constructor(store, Engine, { onStart, onResult, onProblem, request = () => store.request(), inspects = true }) {
    Object.assign(this, { store, onStart, onResult, onProblem, request, inspects });
    this.state = "loading";
    this.id = null;
    this.cell = null;
    this.at = null;
    this.map = null;
    this.inspectedRun = null;
    this.engine = new Engine({ onMessage: (message) => this.receive(message) });
  }

  /** Trains with the store's settings from the start; the newest request wins. */
  start(run = true) {
    this.engine.inspect(null);
    this.state = run ? "training" : "paused";
    this.at = null;
    this.onStart();
    this.id = this.engine.start({ ...this.request(), run, inspect: this.watched() });
  }

  receive(message) {
    if (message.type === "error") {
      this.state = "refused";
      this.onProblem(message.message);
    } else if (message.type === "result") {
      this.state = message.state;
      this.at = message.current?.cell ?? null;
      this.onResult(message);
      if (message.state !== "training" && this.inspects) this.inspectSoon(message);
    } else if (message.type === "past") {
      this.onResult(message);
    } else if (message.type === "inspection") {
      this.onResult({ type: "inspection", inspection: message });
    }
  }

  /** Resumes the run to its end; a finished run starts again. */
  run() {
    if (this.state === "paused") {
      this.state = "training";
      this.engine.run();
    } else if (this.state !== "training") this.start();
  }

  stop() {
    if (this.state === "training") this.engine.stop();
  }

  /** Takes a single step or episode; of a finished run, the first one. The state of a step is then selected. */
  advance(unit) {
    if (this.state === "training") this.engine.stop();
    else if (this.state !== "paused") this.start(false);
    if (unit === "step" && this.at !== null) this.inspect(this.at);
    this.state = "training";
    this.engine.advance(unit);
  }

  /** Shows the agent before its first step. */
  reset() {
    this.start(false);
  }

  /** Sets how many steps a second takes. A run that is at its end starts again, to be watched. */
  setPace(steps) {
    this.engine.setPace(steps);
    if (steps !== Infinity && ["finished", "diverged"].includes(this.state)) this.start();
  }

  /** Shows the numbers of a cell, now and in later results. */
  inspect(cell) {
    this.cell = cell;
    this.inspectedRun = this.id;
    this.engine.inspect(cell);
  }

  /** The cell to watch in the next run, with the size of its map; null to watch that of the first state. */
  watched() {
    const { map, cell } = this;
    return cell !== null && map?.environment === this.store.state.environment ? { cell, columns: map.columns, rows: map.rows } : null;
  }

  /** Inspects a result after it was drawn: the engine repeats the run for a cell that it did not watch. */
  inspectSoon(result) {
    const { id } = this;
    requestAnimationFrame(() => setTimeout(() => id === this.id && this.keepInspecting(result)));
  }

  /** Keeps inspecting the chosen cell in a new run if its map has it, otherwise the start of the greedy episode. */
  keepInspecting({ map, episode }) {
    const { environment } = this.store.state;
    const { columns, rows } = map;
    const same = this.map && this.map.environment === environment && this.map.columns === columns && this.map.rows === rows;
    if (!same) this.cell = null;
    this.map = { environment, columns, rows };
    if (this.inspectedRun === this.id) return;
    const hasValues = this.cell !== null && !Number.isNaN(map.values[this.cell]);
    this.inspect(hasValues ? this.cell : (episode?.cells[0] ?? null));
  }
}
